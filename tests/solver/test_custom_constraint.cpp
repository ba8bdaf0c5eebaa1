#include "body.h"
#include "souple/constraints/distance.h"
#include "souple/error.h"
#include "souple/solver/custom_constraint.h"
#include "souple/solver/set_projector.h"

#include <stdexcept>

#include <gtest/gtest.h>

namespace souple::test_solver_custom_constraint {

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

}  // namespace souple::test_solver_custom_constraint
