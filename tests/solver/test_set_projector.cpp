#include "souple/constraints/distance.h"
#include "souple/solver/set_projector.h"
#include "tests/expect_error.h"

#include <vector>

#include <gtest/gtest.h>

namespace souple {
namespace {

struct Pair {
  std::vector<Vec4f> position, offset, start;
  ParticleView view(Form form) {
    start = form == Form::plain ? position : offset;
    return {position, form == Form::plain ? position : offset, start, form};
  }
};

// Two unequal masses at a distance of 2 m, rest length 1 m: one rigid projection restores the rest length and
// keeps the center of mass.
TEST(SetProjector, RigidDistanceKeepsTheCenterOfMass) {
  for (const Form form : {Form::plain, Form::displacement}) {
    Pair pair{{{0, 0, 0, 1.0f}, {2, 0, 0, 0.25f}}, {{}, {}}, {}};
    SetProjector<Distance> projector;
    projector.add({0, 1}, {1.0f});
    projector.prepare(2);
    const ParticleView view = pair.view(form);
    projector.project(0, view, {.h = 0.01f, .form = form});
    EXPECT_FLOAT_EQ(length(view.difference(0, 1)), 1.0f);
    const float x0 = view.relative(0, {}).x, x1 = view.relative(1, {}).x;
    EXPECT_FLOAT_EQ((x0 + 4 * x1) / 5, 2 * 4 / 5.0f);
  }
}

// XPBD converges to the force balance alpha lambda = -C, whatever the number of iterations.
TEST(SetProjector, ComplianceDoesNotDependOnIterations) {
  Pair pair{{{0, 0, 0, 0.0f}, {2, 0, 0, 1.0f}}, {{}, {}}, {}};
  SetProjector<Distance> projector;
  projector.add({0, 1}, {1.0f}, {1e-4f});
  projector.prepare(2);
  const ParticleView view = pair.view(Form::displacement);
  const Substep substep{.h = 0.01f, .iterations = 7, .mode = Mode::xpbd};
  projector.begin_substep(view, substep);
  for (int i = 0; i < substep.iterations; ++i) projector.project(0, view, substep);
  // alpha~ = 1, w = 1: spring and inertia each take half of the violation of 1 m.
  EXPECT_NEAR(view.relative(1, {}).x, 1.5f, 1e-6f);
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

}  // namespace
}  // namespace souple
