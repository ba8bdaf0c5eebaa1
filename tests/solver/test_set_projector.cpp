#include "souple/constraints/distance.h"
#include "souple/solver/set_projector.h"
#include "tests/expect_error.h"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

namespace souple::test_solver_set_projector {

struct Pair {
  std::vector<Vec4f> position, offset, start;
  ParticleView view() {
    start = offset;
    return {position, offset, start};
  }
};

// Two unequal masses at a distance of 2 m, rest length 1 m. One rigid projection restores the rest length and keeps the
// center of mass.
TEST(SetProjector, RigidDistanceKeepsTheCenterOfMass) {
  Pair pair{{{0, 0, 0, 1.0f}, {2, 0, 0, 0.25f}}, {{}, {}}, {}};
  SetProjector<Distance> projector;
  projector.add({0, 1}, {1.0f});
  projector.prepare(2);
  const ParticleView view = pair.view();
  projector.project(0, view, {.h = 0.01f});
  EXPECT_FLOAT_EQ(length(view.difference(0, 1)), 1.0f);
  const float x0 = view.relative(0, {}).x, x1 = view.relative(1, {}).x;
  EXPECT_FLOAT_EQ((x0 + 4 * x1) / 5, 2 * 4 / 5.0f);
}

// XPBD converges to the force balance alpha lambda = -C, whatever the number of iterations.
TEST(SetProjector, ComplianceDoesNotDependOnIterations) {
  Pair pair{{{0, 0, 0, 0.0f}, {2, 0, 0, 1.0f}}, {{}, {}}, {}};
  SetProjector<Distance> projector;
  projector.add({0, 1}, {1.0f}, {1e-4f});
  projector.prepare(2);
  const ParticleView view = pair.view();
  const Substep substep{.h = 0.01f, .iterations = 7, .mode = Mode::xpbd};
  projector.begin_substep(view, substep);
  for (int i = 0; i < substep.iterations; ++i) projector.project(0, view, substep);
  // alpha~ = 1, w = 1: spring and inertia each take half of the violation of 1 m.
  EXPECT_NEAR(view.relative(1, {}).x, 1.5f, 1e-6f);
}

// A hanging chain of n springs, one sweep per substep from lambda = 0, at rest: how far it is elongated.
double elongation_of_chain(std::uint32_t n, float alpha, bool prepared) {
  std::vector<Vec4f> position, offset(n + 1), velocity(n + 1);
  for (std::uint32_t i = 0; i <= n; ++i)
    position.push_back({0, -static_cast<float>(i), 0, i == 0 ? 0.0f : 1.0f});
  SetProjector<Distance> springs;
  for (std::uint32_t i = 0; i < n; ++i) springs.add({i, i + 1}, {1}, {alpha});
  springs.prepare(n + 1);
  const Substep substep{.h = 0.01f};
  for (int step = 0; step < 4000; ++step) {
    const std::vector<Vec4f> start = offset;
    for (std::uint32_t i = 1; i <= n; ++i) {
      velocity[i].y = 0.97f * velocity[i].y - 9.81f * substep.h;
      offset[i].y += velocity[i].y * substep.h;
    }
    const ParticleView view{position, offset, start};
    if (prepared) springs.prepare_sweeps(view, step == 0);
    springs.begin_substep(view, substep);
    for (int color = 0; color < springs.color_count(); ++color) springs.project(color, view, substep);
    for (std::uint32_t i = 1; i <= n; ++i) velocity[i].y = (offset[i].y - start[i].y) / substep.h;
  }
  return -static_cast<double>(offset[n].y);
}

// sum_i alpha m g (n - i). A sweep that ignores shared particles is too soft by half of h^2 (w_a + w_b) per spring. A
// spring alone is exact in any case.
TEST(SetProjector, OneSweepIsAsCompliantAsTheMaterial) {
  const auto theory = [](std::uint32_t n, double alpha) { return alpha * 9.81 * n * (n + 1) / 2; };
  for (const bool prepared : {false, true})
    EXPECT_NEAR(elongation_of_chain(1, 2e-4f, prepared) / theory(1, 2e-4), 1, 1e-3);
  EXPECT_NEAR(elongation_of_chain(20, 2e-4f, true) / theory(20, 2e-4), 1, 0.06);
  EXPECT_GT(elongation_of_chain(20, 2e-4f, false) / theory(20, 2e-4), 1.4);
}

TEST(SetProjector, SaysWhichParticleIsMissing) {
  SetProjector<Distance> projector;
  projector.add({0, 1}, {1.0f});
  projector.add({1, 7}, {1.0f});
  expect_error([&] { projector.prepare(3); }, {"distance 1 names particle 7, but there are 3"});
}

TEST(SetProjector, ErasingParticlesRenumbers) {
  SetProjector<Distance> projector;
  projector.add({0, 1}, {1.0f});
  projector.add({2, 3}, {1.0f});
  projector.add({1, 2}, {1.0f});
  projector.erase_particles(0, 1);
  projector.prepare(3);
  ASSERT_EQ(projector.size(), 2u);
  EXPECT_EQ(projector.set().indices(0), (std::array<std::uint32_t, 2>{1, 2}));
}

// Two chains of one object each; the second has no inverse masses, like a sleeping object.
TEST(SetProjector, ConstraintsOfSleepingObjectsAreFoundAndMayBeLeftOut) {
  constexpr std::uint32_t n = 20, both = 40;  // particles of a chain, of both
  const auto make = [] {
    SetProjector<Distance> links;
    for (const std::uint32_t first : {0u, n})
      for (std::uint32_t i = 0; i + 1 < n; ++i) links.add({first + i, first + i + 1}, {0.9f}, {1e-4f});
    links.prepare(both);
    return links;
  };
  SetProjector<Distance> links = make();
  const IndexRange asleep[] = {{n, both}};
  const std::vector<IndexRange> found = links.constraints_of(asleep);
  std::vector<bool> left_out(links.size());
  for (const IndexRange& range : found)
    for (std::size_t i = range.begin; i < range.end; ++i) left_out[i] = true;
  for (std::size_t i = 0; i < links.size(); ++i) EXPECT_EQ(left_out[i], links.set().indices(i)[0] >= n) << i;

  const auto solve = [&](bool leaves_out) {
    std::vector<Vec4f> position, offset(both);
    for (std::uint32_t i = 0; i < both; ++i)
      position.push_back({static_cast<float>(i), 0, 0.1f * static_cast<float>(i % 3), i < n ? 1.0f : 0.0f});
    const std::vector<Vec4f> start = offset;
    const ParticleView view{position, offset, start};
    SetProjector<Distance> solved = make();
    Substep substep{.h = 0.01f};
    LeftOut of_solved;
    of_solved.add_ranges(solved, found, solved.size());
    if (leaves_out) substep.asleep = &of_solved;
    solved.begin_substep(view, substep);
    for (int color = 0; color < solved.color_count(); ++color) solved.project(color, view, substep);
    return offset;
  };
  const std::vector<Vec4f> all = solve(false), some = solve(true);
  float most = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    EXPECT_EQ(all[i].xyz(), some[i].xyz()) << i;
    most = std::max(most, length(some[i].xyz()));
  }
  EXPECT_GT(most, 0.01f) << "the awake chain moves";
}

}  // namespace souple::test_solver_set_projector
