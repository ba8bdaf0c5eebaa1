#include "souple/rigid/contact_finder.h"
#include "souple/rigid/contact_solver.h"
#include "souple/rigid/free_motion.h"
#include "souple/threads/threads.h"

#include <cmath>
#include <memory>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

namespace souple {
namespace {

constexpr double g = 9.81;

struct Rough : RigidMaterials {
  bool collide(std::uint32_t, std::uint32_t) const override { return true; }
  ContactMaterialPair at(std::uint32_t, std::uint32_t) const override {
    return {.static_friction = 0.5f, .kinetic_friction = 0.5f};
  }
};

/// Body 0 is a slope about z through the origin, body 1 rolls on it.
struct Slope {
  RigidBodies bodies;
  std::vector<RigidShape> shapes{2};
  Quatd tilt;
  Shape plane{Plane{}};
  std::unique_ptr<Threads> threads = make_threads(Threading::serial, 1);
  Rough rough;
  ContactFinder finder;
  ContactSolver solver;

  Slope(const ConvexShape& shape, const BodyMass& mass, double radius, double angle)
      : tilt(Quatd::from_axis_angle({0, 0, 1}, -angle)) {
    bodies.resize(2);
    bodies.pose[0].rotation = tilt;
    shapes[0].collider = &plane;
    shapes[1].parts = {shape};
    bodies.mass[1] = mass;
    bodies.pose[1] = {rotate(tilt, Vec3d{0, radius, 0}),
                      tilt * Quatd::from_axis_angle({1, 0, 0}, std::numbers::pi / 2)};
    bodies.start = bodies.pose;
    bodies.inverse_inertia[1] = world_inverse_inertia(mass, bodies.pose[1].rotation);
  }
  void step(double dt, int substeps) {
    std::vector<BodyPose> predicted(2);
    const RigidSubstep substep{.h = dt / substeps, .bounce_speed = 2 * g * dt / substeps};
    finder.begin_step(bodies, shapes, rough, dt, 1.0 / substeps, g, *threads);
    solver.prepare(finder.contacts(), bodies);
    for (int i = 0; i < substeps; ++i) {
      if (i > 0) finder.refresh(bodies, shapes, *threads);
      solver.bounce(finder.contacts(), bodies, substep);
      predict_bodies(bodies, {0, -g, 0}, substep.h, predicted);
      solver.solve(finder.contacts(), bodies, substep, *threads);
      finish_bodies(bodies, predicted, substep.h);
    }
  }
  /// Down the slope after a time [m/s].
  double speed_after(double seconds) {
    for (int i = 0; i < std::lround(seconds * 60); ++i) step(1.0 / 60, 10);
    return dot(bodies.velocity[1].linear, rotate(tilt, Vec3d{1, 0, 0}));
  }
};

constexpr double radius = 0.3, half_height = 0.4, mass = 10;

TEST(Rolling, ACylinderRollsDownASlopeWithTwoThirdsOfTheAccelerationOfOneThatSlides) {
  const double across = 12 / (mass * (3 * radius * radius + 4 * half_height * half_height));
  const BodyMass solid{1 / mass, {across, 2 / (mass * radius * radius), across}};
  for (const double angle : {0.05, 0.3}) {
    Slope slope(convex_cylinder(radius, half_height), solid, radius, angle);
    EXPECT_NEAR(slope.speed_after(2) / (2.0 / 3 * g * std::sin(angle) * 2), 1, 1e-3);
  }
}

TEST(Rolling, ASphereWithFiveSevenths) {
  const double inverse = 2.5 / (mass * radius * radius);
  const BodyMass solid{1 / mass, {inverse, inverse, inverse}};
  Slope slope(convex_sphere(radius), solid, radius, 0.3);
  EXPECT_NEAR(slope.speed_after(2) / (5.0 / 7 * g * std::sin(0.3) * 2), 1, 1e-3);
}

}  // namespace
}  // namespace souple
