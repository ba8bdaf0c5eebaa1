#include "body.h"
#include "souple/constraints/distance.h"
#include "souple/error.h"
#include "souple/solver/custom_constraint.h"
#include "souple/solver/set_projector.h"
#include "tests/expect_error.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
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
  std::vector<IndexRange> found;
  links.append_constraints_of(asleep, found);
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

// Residuals as in reports, compared with sums over single constraints in double, on any number of threads.
TEST(Measure, IsTheSumOverConstraintsOnAnyNumberOfThreads) {
  constexpr std::uint32_t links = 5003;  // whole chunks and a remainder
  std::vector<Vec4f> position(links + 1);
  for (std::uint32_t i = 0; i <= links; ++i)
    position[i] = {0.01f * static_cast<float>(i) + 0.004f * std::sin(0.7f * static_cast<float>(i)), 0, 0, 1};
  SetProjector<Distance> chain;
  Residual expected;
  for (std::uint32_t i = 0; i < links; ++i) {
    const float rest = i == 77 ? 0 : 0.008f + 0.001f * static_cast<float>(i % 5);
    chain.add({i, i + 1}, {rest}, {2e-4f});
    const double C = std::fabs(static_cast<double>(position[i + 1].x) - static_cast<double>(position[i].x)) -
                     static_cast<double>(rest);
    expected.largest = std::max(expected.largest, std::fabs(C));
    expected.sum += std::fabs(C);
    expected.energy += 0.5 * C * C / 2e-4;
    if (rest > 0) expected.largest_strain = std::max(expected.largest_strain, C / static_cast<double>(rest));
  }
  chain.prepare(position.size());
  std::vector<Vec4f> unmoved(position.size());
  const ParticleView view{position, unmoved, unmoved};
  const Residual alone = chain.residual(view);
  EXPECT_EQ(alone.count, links);
  EXPECT_NEAR(alone.largest, expected.largest, 1e-5 * expected.largest);
  EXPECT_NEAR(alone.sum, expected.sum, 1e-4 * expected.sum);
  EXPECT_NEAR(alone.energy, expected.energy, 1e-4 * expected.energy);
  EXPECT_NEAR(alone.largest_strain, expected.largest_strain, 1e-4 * expected.largest_strain);
  for (const int count : {1, 2, 3, 8}) {
    const auto threads = make_threads(Threading::automatic, count);
    const Residual together = chain.residual(view, threads.get());
    EXPECT_EQ(together.count, alone.count);
    EXPECT_EQ(together.largest, alone.largest);
    EXPECT_EQ(together.sum, alone.sum);
    EXPECT_EQ(together.largest_strain, alone.largest_strain);
  }
}

using namespace test;  // NOLINT(google-build-using-namespace)

float distance(std::span<const Vec3f> x, std::span<Vec3f> gradient) {
  const Vec3f d = x[0] - x[1];
  gradient[0] = normalized(d);
  gradient[1] = -gradient[0];
  return length(d) - 1;
}

std::shared_ptr<CallbackConstraint> callback(std::vector<std::uint32_t> particles,
                                             CallbackConstraint::Function f) {
  return std::make_shared<CallbackConstraint>(std::move(particles), std::move(f));
}

Body pair() {
  Body body;
  body.add({0, 0, 0}, 1);
  body.add({2, 0.5, 0}, 0.25f);
  body.offset[1].y = 0.01f;
  return body;
}

// A custom distance constraint gives the result of the built-in distance constraint, in every mode.
TEST(CustomConstraint, FollowsTheFormulasOfTheStaticKinds) {
  for (const Mode mode : {Mode::small_steps, Mode::xpbd, Mode::pbd}) {
    Body a = pair(), b = pair();
    SetProjector<Distance> built_in;
    built_in.add({0, 1}, {1}, {1e-4f}, 0.02f, 0.4f);
    built_in.prepare(2);
    const auto constraint = callback({0, 1}, distance);
    constraint->compliance = 1e-4f;
    constraint->damping_time = 0.02f;
    constraint->stiffness = 0.4f;
    CustomProjector custom;
    custom.add(constraint);
    custom.prepare(2);
    const Substep substep{.h = 0.01f, .iterations = 4, .mode = mode};
    solve(built_in, a, substep);
    solve(custom, b, substep);
    for (std::size_t i = 0; i < 2; ++i) EXPECT_LT(length(a.at(i) - b.at(i)), 1e-6);
    EXPECT_NEAR(custom.residual(b.view()).largest, built_in.residual(a.view()).largest, 1e-6);
    if (mode == Mode::pbd) continue;  // has no damping
    std::vector<Vec4f> v{{1, 2, 3, 0}, {-2, 0.5f, 1, 0}}, w = v;
    const auto threads = make_threads(Threading::serial, 1);
    built_in.damp(a.view(), v, substep, *threads);
    custom.damp(b.view(), w, substep, *threads);
    EXPECT_GT(length(v[0].xyz() - Vec3f{1, 2, 3}), 0.1f);
    for (std::size_t i = 0; i < 2; ++i) EXPECT_LT(length(v[i].xyz() - w[i].xyz()), 1e-5f);
    EXPECT_EQ(custom.take_error(), "");
  }
}

// Keeps the mean height of any number of particles at or above 1.
float mean_height(std::span<const Vec3f> x, std::span<Vec3f> gradient) {
  float sum = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    sum += x[i].y / static_cast<float>(x.size());
    gradient[i] = {0, 1 / static_cast<float>(x.size()), 0};
  }
  return sum - 1;
}

TEST(CustomConstraint, InequalityOverManyParticlesPushesOnly) {
  for (const double height : {0.0, 3.0}) {
    Body body;
    for (int i = 0; i < 50; ++i) body.add({0.1 * i, height, 0}, i == 7 ? 0.0f : 1.0f);
    const auto constraint = callback(first(50), mean_height);
    constraint->sense = Sense::non_negative;
    CustomProjector projector;
    projector.add(constraint);
    projector.prepare(50);
    solve(projector, body, {.h = 0.01f, .iterations = 3});
    double mean = 0;
    for (std::size_t i = 0; i < 50; ++i) mean += body.at(i).y / 50;
    EXPECT_NEAR(mean, std::fmax(1, height), 1e-6);
    EXPECT_EQ(body.at(7).y, height);
    EXPECT_LT(projector.residual(body.view()).largest, 1e-6);
  }
}

TEST(CustomConstraint, FailuresMoveNothingAndAreReported) {
  struct Case {
    const char* text;
    CallbackConstraint::Function function;
  };
  const Case cases[] = {
      {"no luck", [](auto, auto) -> float { throw std::runtime_error("no luck"); }},
      {"not a std::exception", [](auto, auto) -> float { throw 42; }},
      {"bad_function_call", {}},
      {"not finite",
       [](auto, auto gradient) {
         return gradient[0] = {1, 0, 0}, NAN;
       }},
      {"not finite",
       [](auto, auto gradient) {
         return gradient[0] = {INFINITY, 0, 0}, 1.0f;
       }},
      {"not finite",
       [](auto, auto gradient) {
         return gradient[0] = {1e-30f, 0, 0}, 1e30f;
       }},
  };
  for (const Case& c : cases) {
    Body body = pair();
    const auto before = body.all();
    const auto bad = callback({0, 1}, c.function);
    bad->name = "bad one";
    CustomProjector projector;
    projector.add(bad);
    projector.prepare(2);
    EXPECT_NO_THROW(solve(projector, body, {.h = 0.01f, .iterations = 3}));
    EXPECT_EQ(body.at(0), before[0]);
    EXPECT_EQ(body.at(1), before[1]);
    const std::string error = projector.take_error();
    EXPECT_NE(error.find("'bad one'"), std::string::npos) << error;
    EXPECT_NE(error.find(c.text), std::string::npos) << error;
    EXPECT_EQ(projector.take_error(), "");
  }
}

TEST(CustomConstraint, OneThatFailsOnceIsTriedAgain) {
  Body body = pair();
  int calls = 0;
  CustomProjector projector;
  projector.add(callback({0, 1}, [&](auto x, auto gradient) {
    if (++calls == 1) throw std::runtime_error("once");
    return distance(x, gradient);
  }));
  projector.prepare(2);
  solve(projector, body, {.h = 0.01f, .iterations = 2});
  EXPECT_NEAR(length(body.at(0) - body.at(1)), 1, 1e-6);
  EXPECT_NE(projector.take_error().find("once"), std::string::npos);
}

class Near final : public CustomConstraint {
 public:
  std::span<const std::uint32_t> particles() const override { return particles_; }
  float evaluate(std::span<const Vec3f> x, std::span<Vec3f> gradient) override {
    gradient[0] = {1, 0, 0};
    return x[0].x - 0.125f;
  }
  Vec3f origin() const override { return {10000, 0, 0}; }

 private:
  std::vector<std::uint32_t> particles_{0};
};

TEST(CustomConstraint, ItsOriginKeepsDigitsFarAway) {
  Body body;
  body.add({10000, 0, 0}, 1);
  body.offset[0].x = 0.12501f;
  CustomProjector projector;
  projector.add(std::make_shared<Near>());
  projector.prepare(1);
  solve(projector, body, {.h = 0.01f});
  EXPECT_NEAR(body.at(0).x, 10000.125, 1e-7);
}

TEST(CustomConstraint, ErasingParticlesDropsAndRenumbers) {
  CustomProjector projector;
  projector.add(callback({0, 1}, distance));
  projector.add(callback({2, 3}, distance));
  projector.erase_particles(0, 1);
  projector.prepare(3);
  ASSERT_EQ(projector.size(), 1u);
  Body body;
  for (int i = 0; i < 3; ++i) body.add({2.0 * i, 0, 0}, 1);
  solve(projector, body, {.h = 0.01f});
  EXPECT_EQ(body.at(0).x, 0);
  EXPECT_NEAR(length(body.at(1) - body.at(2)), 1, 1e-6);
}

TEST(CustomConstraint, RefusesBadInput) {
  CustomProjector projector;
  EXPECT_THROW(projector.add(nullptr), Error);
  EXPECT_THROW(projector.add(callback({}, distance)), Error);
  EXPECT_THROW(projector.add(callback({1, 1}, distance)), Error);
  const auto stiff = callback({0, 1}, distance);
  stiff->stiffness = 2;
  EXPECT_THROW(projector.add(stiff), Error);
  EXPECT_EQ(projector.size(), 0u);
}

}  // namespace souple::test_solver_set_projector
