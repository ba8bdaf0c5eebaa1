#include "souple/solver/marching.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

namespace souple {
namespace {

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

}  // namespace
}  // namespace souple
