#include "souple/math/vec3.h"
#include "souple/multilevel/marching.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

namespace souple::test_solver_marching {

/// Links of a flat sheet of n x n particles, one unit apart: edges, one diagonal and, if `across`, distances across the
/// interior edges.
struct Sheet {
  int side;
  std::vector<Link> links;
  std::unique_ptr<Threads> threads = make_threads(Threading::serial, 1);
  LinkEnds ends;
  LinkTriangles triangles;

  Sheet(int n, bool across)
      : side(n),
        links(links_of(n, across)),
        ends(links, static_cast<std::size_t>(n * n), *threads),
        triangles(links, ends, *threads) {}
  static std::vector<Link> links_of(int n, bool across) {
    std::vector<Link> links;
    const int steps[6][2] = {{1, 0}, {0, 1}, {1, 1}, {1, -1}, {2, 1}, {1, 2}};
    for (int k = 0; k < (across ? 6 : 3); ++k)
      for (int row = 0; row < n; ++row)
        for (int column = 0; column < n; ++column) {
          const int to_column = column + steps[k][0], to_row = row + steps[k][1];
          if (to_column >= n || to_row >= n || to_row < 0) continue;
          const auto a = static_cast<std::uint32_t>(row * n + column);
          const auto b = static_cast<std::uint32_t>(to_row * n + to_column);
          links.push_back(
              {std::min(a, b), std::max(a, b), static_cast<float>(std::hypot(steps[k][0], steps[k][1]))});
        }
    return links;
  }
  double straight(std::uint32_t a, std::uint32_t b) const {
    const auto n = static_cast<std::uint32_t>(side);
    const std::uint32_t row_a = a / n, row_b = b / n;
    return std::hypot(static_cast<double>(a % n) - static_cast<double>(b % n),
                      static_cast<double>(row_a) - static_cast<double>(row_b));
  }
};

// Paths along links alone are up to 8 % too long.
TEST(Marching, LengthsOnAFlatSheetAreStraight) {
  for (const bool across : {false, true}) {
    const Sheet sheet(41, across);
    const std::uint32_t middle = 20 * 41 + 20;
    Marcher marcher(sheet.triangles);
    const auto reached = marcher.march(middle, 12);
    EXPECT_GT(reached.size(), 400u) << "of 441 within 12 units";
    for (const Marcher::Reached& r : reached) {
      const double straight = sheet.straight(middle, r.particle);
      EXPECT_LE(r.length, 12);
      EXPECT_GE(static_cast<double>(r.length), straight * (1 - 1e-5));
      EXPECT_LE(static_cast<double>(r.length), straight * 1.01) << r.particle;
    }
    EXPECT_TRUE(std::is_sorted(reached.begin(), reached.end(),
                               [](const auto& p, const auto& q) { return p.length < q.length; }));
  }
}

TEST(Marching, MarchesFromOneSourceDoNotSeeAnother) {
  const Sheet sheet(41, true);
  Marcher used(sheet.triangles), fresh(sheet.triangles);
  used.march(20 * 41 + 20, 9);
  const auto again = used.march(22 * 41 + 18, 5);
  const auto first = fresh.march(22 * 41 + 18, 5);
  ASSERT_EQ(again.size(), first.size());
  for (std::size_t k = 0; k < first.size(); ++k) {
    EXPECT_EQ(again[k].particle, first[k].particle);
    EXPECT_EQ(again[k].length, first[k].length);
  }
}

TEST(Marching, BeyondAreTheNeighborsOfThoseReached) {
  const Sheet sheet(41, true);
  const std::uint32_t middle = 20 * 41 + 20;
  Marcher marcher(sheet.triangles);
  marcher.march(middle, 4.5f);
  std::size_t within_a_link = 0;
  for (const Marcher::Reached& r : marcher.beyond()) {
    const double straight = sheet.straight(middle, r.particle);
    EXPECT_GT(straight, 4.5);
    EXPECT_NEAR(static_cast<double>(r.length), straight, 0.05 * straight);
    within_a_link += straight < 5.5;
  }
  std::size_t expected = 0;
  for (std::uint32_t i = 0; i < 41 * 41; ++i)
    expected += sheet.straight(middle, i) > 4.5 && sheet.straight(middle, i) < 5.5;
  EXPECT_EQ(within_a_link, expected);
}

TEST(Marching, AMarchGoesOnUntilItHasReachedEnough) {
  const Sheet sheet(41, true);
  Marcher marcher(sheet.triangles);
  std::size_t count = 0;
  const auto reached = marcher.march(0, 1, 40, [&](std::uint32_t) { return ++count >= 50; });
  EXPECT_EQ(reached.size(), 50u);
  EXPECT_GT(reached.back().length, 1);
}

TEST(Marching, ALineThatMissesTheEdgeIsNotUnfolded) {
  // A square of side 1, cut by its diagonal from u to w: the other diagonal is straight.
  const float c = std::sqrt(2.0f);
  EXPECT_NEAR(unfolded_length(1, 1, c, 1, 1), std::sqrt(2.0f), 1e-6f);
  // From far away, beyond one end of the edge.
  EXPECT_TRUE(std::isinf(unfolded_length(5, 5.8f, 1, 1, 1)));
}

/// A flat sheet of n x n unit cells whose inner vertices are moved by up to 0.25.
struct IrregularSheet {
  std::vector<Vec3d> x;
  std::vector<Link> links;

  explicit IrregularSheet(int n) {
    std::uint32_t state = 1;
    const auto random = [&state] {
      state = state * 1664525u + 1013904223u;
      return 0.25 * (static_cast<double>(state >> 8) / (1u << 23) - 1);
    };
    for (int row = 0; row < n; ++row)
      for (int column = 0; column < n; ++column) {
        const bool inner = row > 0 && row + 1 < n && column > 0 && column + 1 < n;
        x.push_back({column + (inner ? random() : 0), row + (inner ? random() : 0), 0});
      }
    for (const Link& link : Sheet::links_of(n, false))
      links.push_back({link.a, link.b, static_cast<float>(length(x[link.a] - x[link.b]))});
  }
};

// Some particles of obtuse corners are nearer to a coarse particle than all their neighbors. A path that ended there
// made links of half their length.
TEST(Levels, CoarseLinksOfAnIrregularSheetAreNoShorterThanStraight) {
  const IrregularSheet sheet(60);
  const std::vector<float> masses(sheet.x.size(), 1.0f);
  const auto threads = make_threads(Threading::serial, 1);
  const std::vector<CoarseLevel> levels = build_levels(sheet.links, masses, 24, *threads);
  ASSERT_FALSE(levels.empty());
  const CoarseLevel& level = levels.front();
  double mean = 0;
  for (std::size_t e = 0; e < level.links.size(); ++e) {
    const Link& link = level.links[e];
    const double straight = length(sheet.x[level.finer[link.a]] - sheet.x[level.finer[link.b]]);
    // Unfolded from lengths that are themselves found to a few percent.
    EXPECT_GE(static_cast<double>(link.length), straight * 0.97) << e;
    mean += static_cast<double>(link.length) / straight / static_cast<double>(level.links.size());
    double path = 0;
    for (std::uint32_t k = level.path_begin[e]; k < level.path_begin[e + 1]; ++k)
      path += static_cast<double>(sheet.links[level.path[k]].length);
    EXPECT_GE(path, straight * (1 - 1e-5)) << e << ": its path ends on the way";
  }
  EXPECT_LT(mean, 1.02);
}

}  // namespace souple::test_solver_marching
