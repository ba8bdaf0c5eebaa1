#include "souple/multilevel/level_links.h"
#include "souple/simd/instruction_set.h"
#include "souple/solver/kernels/find_kernels.h"
#include "souple/solver/kernels/links.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <gtest/gtest.h>

namespace souple::test_solver_level_links {

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

}  // namespace souple::test_solver_level_links
