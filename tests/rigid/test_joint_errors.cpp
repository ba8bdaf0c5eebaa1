#include "souple/error.h"
#include "tests/rigid/joint_world.h"

#include <cmath>
#include <limits>
#include <string>

#include <gtest/gtest.h>

// Errors of users, and joints that cannot hold.

namespace souple::test_rigid_joint_errors {

using joint::Axis;
using joint::Joint;
using joint::Motor;
using joint::Spring;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// The message names the joint and contains `part`.
void expect_refused(Joint joint, const std::string& part) {
  joint.name = "left knee";
  joint::Joints joints;
  try {
    add(joints, joint, 2);
    ADD_FAILURE() << "accepted; expected: " << part;
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("left knee"), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
  }
  EXPECT_EQ(joints.size(), 0u);
}

Joint between(const joint::Kind& kind) {
  return {.name = {}, .a = 0, .b = 1, .kind = kind};
}

TEST(JointErrors, BadDescriptionsAreRefusedByName) {
  using joint::Ball, joint::Distance, joint::Fixed, joint::Hinge, joint::Pulley, joint::Slider,
      joint::Universal;
  using joint::unlimited;
  expect_refused({.name = {}, .a = 0, .b = 2, .kind = Fixed{}}, "body 2 does not exist");
  expect_refused({.name = {}, .a = 1, .b = 1, .kind = Fixed{}}, "to itself");
  expect_refused({.name = {}, .kind = Fixed{}}, "the world to itself");
  Joint joint = between(Hinge{});
  joint.frame_a.rotation = {0, 0, 0, 0};
  expect_refused(joint, "rotation of frame_a");
  joint = between(Hinge{});
  joint.frame_b.point.y = nan;
  expect_refused(joint, "point of frame_b");
  joint = between(Hinge{});
  joint.breaking_force = 0;
  expect_refused(joint, "breaking_force");
  joint = between(Hinge{});
  joint.breaking_torque = nan;
  expect_refused(joint, "breaking_torque");
  expect_refused(between(Hinge{.rotation = Axis{.limits = {1, -1}}}), "limits of the rotation are 1 to -1");
  expect_refused(between(Slider{.translation = Axis{.limits = {nan, 1}}}), "limits of the translation");
  expect_refused(between(Hinge{.compliance = -1}), "compliance is -1");
  expect_refused(between(Fixed{.angular_damping = nan}), "angular_damping");
  expect_refused(between(Slider{.translation = Axis{.spring = Spring{0, -1, 0}}}), "compliance of a spring");
  expect_refused(between(Slider{.translation = Axis{.spring = Spring{0, unlimited, 0}}}), "does nothing");
  expect_refused(between(Universal{.second = Axis{.motor = Motor{.target = nan}}}), "target of a motor");
  expect_refused(between(Universal{.first = Axis{.motor = Motor{.max_force = -1}}}), "max_force");
  expect_refused(between(Ball{.max_swing = -0.1}), "max_swing");
  expect_refused(between(Ball{.twist = {-4, 0}}), "-pi to pi");
  expect_refused(between(Distance{.shortest = 2, .longest = 1}), "expected the shortest first");
  expect_refused(between(Distance{.shortest = -2, .longest = 1}), "shortest length");
  expect_refused(between(Pulley{.ratio = 0}), "ratio");
  expect_refused(between(Pulley{.length = nan}), "length");
}

TEST(JointErrors, AnAxisWithoutLengthIsRefused) {
  RigidBodies bodies;
  bodies.resize(2);
  Joint joint = between(joint::Hinge{});
  place(joint, bodies, {}, joint::axes_along({0, 0, 0}));
  expect_refused(joint, "rotation of frame_a");
}

bool is_calm(const JointWorld& world, double speed) {
  for (std::size_t i = 0; i < world.bodies.size(); ++i)
    if (!is_finite(world.bodies.pose[i].position) || !(length(world.bodies.velocity[i].linear) < speed) ||
        !(length(world.bodies.velocity[i].angular) < 100))
      return false;
  return true;
}

TEST(JointErrors, JointsThatContradictEachOtherStayCalm) {
  for (const joint::Method method : {joint::Method::direct, joint::Method::sweep}) {
    JointWorld world;
    world.solver.method = method;
    const auto a = world.add_box(1, {0.3, 0.2, 0.1}, {}), b = world.add_box(1000, {0.3, 0.2, 0.1}, {1, 0, 0});
    for (const auto& [body, point] :
         {std::pair{a, Vec3d{-1, 0, 0}}, {a, Vec3d{1, 2, 0}}, {b, Vec3d{3, 0, 0}}}) {
      joint::Joint joint{.name = "pin", .b = body, .kind = joint::Fixed{}};
      joint.frame_a.point = point;
      add(world.joints, joint, world.bodies.size());
    }
    for (const double length : {0.1, 4.0}) {
      joint::Joint joint{.name = "rod", .a = a, .b = b, .kind = joint::Distance{length, length}};
      add(world.joints, joint, world.bodies.size());
    }
    add(world.joints,
        {.name = "hinge", .a = a, .b = b, .frame_a = {{}, {1, 0, 0, 0}}, .kind = joint::Hinge{}},
        world.bodies.size());
    bool calm = true;
    world.run(5, [&] { calm = calm && is_calm(world, 100); });
    EXPECT_TRUE(calm) << static_cast<int>(method);
  }
}

TEST(JointErrors, AJointThatIsAssembledApartClosesWithoutAShot) {
  JointWorld world;
  world.gravity = {};
  const auto a = world.add_box(1, {0.3, 0.2, 0.1}, {}), b = world.add_box(1, {0.3, 0.2, 0.1}, {2, 1, 0});
  world.bodies.pose[b].rotation = normalized(Quatd{0.3, 0.5, -0.2, 0.4});
  const auto j =
      add(world.joints, {.name = "weld", .a = a, .b = b, .kind = joint::Fixed{}}, world.bodies.size());
  bool calm = true;
  world.run(2, [&] { calm = calm && is_calm(world, 50); });
  EXPECT_TRUE(calm);
  const joint::JointError error = error_of(world.joints.joint[j], world.joints.state[j], world.bodies);
  EXPECT_LT(error.distance, 1e-5);
  EXPECT_LT(error.angle, 1e-5);
  EXPECT_LT(length(world.momentum()), 1e-9);
}

TEST(JointErrors, JointsToBodiesThatNothingMovesDoNothing) {
  JointWorld world;
  const auto a = world.add_box(1, {0.3, 0.2, 0.1}, {});
  world.bodies.mass[a] = {};
  world.bodies.inverse_inertia[a] = {};
  const auto j = world.add_joint(joint::Fixed{}, no_body, a, {});
  world.run(0.1);
  EXPECT_EQ(world.bodies.pose[a].position, Vec3d{});
  EXPECT_EQ(length(world.joints.state[j].force), 0);
}

}  // namespace souple::test_rigid_joint_errors
