#include "souple/math/vec3.h"
#include "souple/multilevel/level_links.h"
#include "souple/multilevel/marching.h"
#include "souple/simd/instruction_set.h"
#include "souple/solver/kernels/find_kernels.h"
#include "souple/solver/kernels/links.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <set>
#include <vector>

#include <gtest/gtest.h>

namespace souple::test_solver_levels {

constexpr std::size_t lanes = 16;

/// 60 particles in a row, the first two fixed; each is linked to the next three.
CoarseLevel row() {
  CoarseLevel level;
  for (std::uint32_t i = 0; i < 60; ++i) {
    level.mass.push_back(i < 2 ? 0 : 0.1f + 0.01f * static_cast<float>(i));
    for (std::uint32_t k = 1; k <= 3 && i + k < 60; ++k)
      level.links.push_back({i, i + k, static_cast<float>(k)});
  }
  return level;
}

std::vector<std::uint32_t> all_of(const CoarseLevel& level) {
  std::vector<std::uint32_t> links;
  for (std::uint32_t e = 0; e < level.links.size(); ++e) links.push_back(e);
  return links;
}

/// Records of the level with the padding's: irregular positions, and displacements with inverse masses.
struct Records {
  std::vector<Vec4f> position, moving;
  explicit Records(const CoarseLevel& level) {
    for (std::size_t i = 0; i < level.mass.size(); ++i) {
      const float t = static_cast<float>(i), w = level.mass[i] > 0 ? 1 / level.mass[i] : 0;
      position.push_back({1.1f * t, std::sin(t), 0.3f * std::cos(3 * t), w});
      moving.push_back({0.01f * std::sin(5 * t), w > 0 ? -0.02f : 0, 0.01f * std::cos(7 * t), w});
    }
    position.emplace_back(), moving.emplace_back();
  }
};

/// Limits of every link from its rest length alone; positions of the level are those of the world.
void measure(LevelLinks& links, const CoarseLevel& level, const Records& records) {
  std::vector<std::uint32_t> a, b;
  std::vector<float> rest_length, stretch(links.slots());
  for (std::size_t s = 0; s < links.slots(); ++s) {
    const bool padding = links.link(s) == LevelLinks::none;
    const Link link = padding ? Link{.length = 1} : level.links[links.link(s)];
    a.push_back(4 * link.a), b.push_back(4 * link.b), rest_length.push_back(link.length);
  }
  const auto threads = make_threads(Threading::serial, 1);
  const float* const position = &records.position.data()->x;
  links.measure({.position = position,
                 .moving = &records.moving.data()->x,
                 .start = position,
                 .start_a = a.data(),
                 .start_b = b.data(),
                 .rest_length = rest_length.data(),
                 .stretch = stretch.data()},
                *threads);
}

TEST(LevelLinks, EachLinkHasASlotAndNoColorNamesAParticleTwice) {
  const CoarseLevel level = row();
  const LevelLinks links(level, all_of(level));
  EXPECT_EQ(links.swept(), level.links.size() - 1);  // one is between the fixed particles
  EXPECT_EQ(links.slots() % lanes, 0);
  std::set<std::uint32_t> seen;
  for (std::size_t first = 0; first < links.slots(); first += lanes) {
    std::set<std::uint32_t> particles;  // of one register
    for (std::size_t s = first; s < first + lanes; ++s) {
      const std::uint32_t e = links.link(s);
      if (e == LevelLinks::none) continue;
      EXPECT_TRUE(seen.insert(e).second) << e;
      EXPECT_TRUE(particles.insert(level.links[e].a).second) << e;
      EXPECT_TRUE(particles.insert(level.links[e].b).second) << e;
    }
  }
  EXPECT_EQ(seen.size(), level.links.size());
}

// The formulas in double precision, link by link.
TEST(LevelLinks, ASweepBringsEachLinkBetweenItsLimits) {
  const CoarseLevel level = row();
  LevelLinks links(level, all_of(level));
  Records records(level);
  measure(links, level, records);
  std::vector<Vec3d> d;
  for (const Vec4f& moving : records.moving) d.push_back(Vec3d(moving.xyz()));
  for (std::size_t s = 0; s < links.slots(); ++s) {
    if (links.link(s) == LevelLinks::none) continue;
    const Link& link = level.links[links.link(s)];
    const double w_a = static_cast<double>(records.moving[link.a].w),
                 w_b = static_cast<double>(records.moving[link.b].w);
    if (w_a + w_b == 0) continue;
    links.set_gain(s, static_cast<float>(1 / (w_a + w_b)));
    const Vec3d X(records.position[link.a].xyz() - records.position[link.b].xyz());
    const Vec3d predicted = X + Vec3d(records.moving[link.a].xyz()) - Vec3d(records.moving[link.b].xyz());
    const double most = static_cast<double>(link.length),
                 least = std::min({most, length(X), length(predicted)});
    const Vec3d u = X + d[link.a] - d[link.b];
    const Vec3d p = u * ((length(u) - std::clamp(length(u), least, most)) / (w_a + w_b) / length(u));
    d[link.a] -= p * w_a, d[link.b] += p * w_b;
  }
  const auto threads = make_threads(Threading::serial, 1);
  links.sweep(1, 1, records.moving, *threads);
  for (std::size_t i = 0; i < level.mass.size(); ++i)
    EXPECT_LT(length(Vec3d(records.moving[i].xyz()) - d[i]), 2e-6) << i;
}

TEST(LevelLinks, ASweepKeepsMomentumOfFreeParticles) {
  CoarseLevel level = row();
  level.mass[0] = level.mass[1] = 0.2f;
  LevelLinks links(level, all_of(level));
  Records records(level);
  measure(links, level, records);
  for (std::size_t s = 0; s < links.slots(); ++s) {
    if (links.link(s) == LevelLinks::none) continue;
    const Link& link = level.links[links.link(s)];
    links.set_gain(s, 1 / (records.moving[link.a].w + records.moving[link.b].w));
  }
  const auto momentum = [&] {
    Vec3d sum{};
    for (std::size_t i = 0; i < level.mass.size(); ++i)
      sum += Vec3d(records.moving[i].xyz()) * static_cast<double>(level.mass[i]);
    return sum;
  };
  const Vec3d before = momentum();
  const auto threads = make_threads(Threading::serial, 1);
  links.sweep(3, 1.6f, records.moving, *threads);
  EXPECT_LT(length(momentum() - before), 1e-5);
}

/// Results of the kernels of stretched links for 60 particles.
struct Stretched {
  std::vector<std::uint16_t> found;
  std::vector<float> x, y, z, min_length, max_length, gain;
};

Stretched stretched_links(const kernels::LinkKernels& of) {
  const CoarseLevel level = row();
  const Records records(level);
  std::vector<std::uint32_t> a, b;
  std::vector<float> longest, compliance, inverse_mass;
  for (const Link& link : level.links) {
    a.push_back(4 * link.a), b.push_back(4 * link.b), longest.push_back(1.15f * link.length);
    compliance.push_back(1e-6f * static_cast<float>(link.a % 7));
    inverse_mass.push_back(1 + records.position[link.a].w + records.position[link.b].w);
  }
  while (a.size() % lanes != 0)
    a.push_back(0), b.push_back(0), longest.push_back(1), compliance.push_back(0), inverse_mass.push_back(1);
  const std::size_t count = a.size();
  Stretched s{std::vector<std::uint16_t>(count / lanes),
              std::vector<float>(count),
              std::vector<float>(count),
              std::vector<float>(count),
              std::vector<float>(count),
              std::vector<float>(count),
              std::vector<float>(count)};
  const float *const position = &records.position.data()->x, *const moving = &records.moving.data()->x;
  of.find_stretched({a.data(), b.data(), longest.data()}, position, moving, s.found.data(), 0, count / lanes);
  of.measure_stretched({a.data(), b.data(), s.x.data(), s.y.data(), s.z.data(), s.min_length.data(),
                        s.max_length.data(), s.gain.data()},
                       {longest.data(), compliance.data(), inverse_mass.data(), 0.9f, 1e-6f, 3e5f}, position,
                       moving, s.gain.data(), 0, count);
  for (std::size_t e = 0; e < level.links.size(); ++e) {
    const Link& link = level.links[e];
    const Vec3f u = (records.position[link.a].xyz() - records.position[link.b].xyz()) +
                    (records.moving[link.a].xyz() - records.moving[link.b].xyz());
    EXPECT_EQ((s.found[e / lanes] >> (e % lanes)) & 1, length(u) > longest[e]) << e;
    EXPECT_FLOAT_EQ(s.min_length[e], std::min(0.9f * longest[e], length(u))) << e;
  }
  return s;
}

TEST(LevelLinks, StretchedLinksAreTheSameForAnyInstructionSet) {
  const Stretched expected = stretched_links(link_kernels());
  for (const InstructionSet set : {InstructionSet::sse, InstructionSet::avx2, InstructionSet::avx512}) {
    const kernels::LinkKernels* const kernels = set <= instruction_set() ? find_link_kernels(set) : nullptr;
    if (kernels == nullptr) continue;
    const Stretched s = stretched_links(*kernels);
    EXPECT_EQ(s.found, expected.found);
    EXPECT_EQ(s.x, expected.x);
    EXPECT_EQ(s.min_length, expected.min_length);
    EXPECT_EQ(s.max_length, expected.max_length);
    EXPECT_EQ(s.gain, expected.gain);
  }
}

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

}  // namespace souple::test_solver_levels
