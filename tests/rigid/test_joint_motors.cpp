#include "tests/rigid/joint_world.h"

#include <cmath>

#include <gtest/gtest.h>

namespace souple::test_rigid_joint_motors {

using joint::Axis;
using joint::Hinge;
using joint::Motor;
using joint::Slider;
using joint::Spring;

constexpr double g = 9.81;

/// A wheel of 0.5 kg m^2 on the z axis.
struct Wheel {
  JointWorld world;
  std::uint32_t body, joint;

  explicit Wheel(const Motor& motor) {
    body = world.add_body(4, {0.3, 0.3, 0.5}, {});
    joint = world.add_joint(Hinge{.rotation = Axis{.motor = motor}}, no_body, body, {}, {0, 0, 1});
  }
  double spin() const { return world.bodies.velocity[body].angular.z; }
  double torque() const { return world.joints.state[joint].torque.z; }
};

TEST(JointMotor, ReachesItsSpeedInTheTimeOfItsTorque) {
  Wheel wheel({.target = 6, .max_force = 1});  // 2 rad/s^2
  wheel.world.run(1.5);
  EXPECT_NEAR(wheel.spin(), 3, 0.01);
  EXPECT_NEAR(wheel.torque(), 1, 1e-6);
  wheel.world.run(2);
  EXPECT_NEAR(wheel.spin(), 6, 1e-4);
  EXPECT_NEAR(wheel.torque(), 0, 1e-3);
}

TEST(JointMotor, HoldsALoadUpToItsTorqueAndNoMore) {
  Wheel strong({.target = 6, .max_force = 1}), weak({.target = 6, .max_force = 1});
  strong.world.torque[strong.body] = {0, 0, -0.98}, weak.world.torque[weak.body] = {0, 0, -1.02};
  strong.world.run(170), weak.world.run(10);
  EXPECT_NEAR(strong.spin(), 6, 0.1);
  EXPECT_NEAR(strong.torque(), 0.98, 0.01);
  EXPECT_NEAR(weak.spin(), -0.02 * 10 / 0.5, 0.01);
  EXPECT_NEAR(weak.torque(), 1, 1e-6);
}

TEST(JointMotor, StallsWhereTheLoadIsAsLargeAsItsTorque) {
  JointWorld world;
  const auto rod = world.add_box(2, {0.1, 1, 0.1}, {0, -0.5, 0});
  const auto j = world.add_joint(Hinge{.rotation = Axis{.spring = Spring{0, joint::unlimited, 3},
                                                        .motor = Motor{.target = 2, .max_force = g * 0.5}}},
                                 no_body, rod, {}, {0, 0, 1});
  world.run(20);
  // m g l / 2 sin(angle) = half of m g l / 2.
  EXPECT_NEAR(world.joints.state[j].angle[0], pi / 6, 0.01 * std::numbers::pi / 6);
}

TEST(JointMotor, AServoReachesItsPositionWithoutOvershoot) {
  Wheel wheel({.kind = Motor::Target::position, .target = 9, .max_force = 1});
  double most = 0;
  wheel.world.run(8, [&] { most = std::max(most, wheel.world.joints.state[wheel.joint].angle[0]); });
  EXPECT_NEAR(wheel.world.joints.state[wheel.joint].angle[0], 9, 1e-3);
  EXPECT_LT(most, 9 + 1e-3);
  EXPECT_NEAR(wheel.spin(), 0, 1e-3);
}

TEST(JointMotor, AServoOfACertainComplianceIsBentByItsLoad) {
  Wheel wheel({.kind = Motor::Target::position, .target = 1, .compliance = 0.1, .damping = 2});
  wheel.world.torque[wheel.body] = {0, 0, 2};
  wheel.world.run(10);
  EXPECT_NEAR(wheel.world.joints.state[wheel.joint].angle[0], 1.2, 1e-4);
}

TEST(JointMotor, ALimitHoldsAgainstIt) {
  JointWorld world;
  world.gravity = {};
  const auto box = world.add_box(2, {0.1, 0.1, 0.1}, {});
  const auto j = world.add_joint(
      Slider{.translation = Axis{.limits = {-1, 0.5}, .motor = Motor{.target = 1, .max_force = 30}}}, no_body,
      box, {});
  world.run(2);
  EXPECT_NEAR(world.bodies.pose[box].position.x, 0.5, 1e-5);
  EXPECT_LT(length(world.joints.state[j].force), 1e-3);
  EXPECT_LT(world.worst.distance, 1e-5);
}

TEST(JointMotor, ABallSpringTurnsToItsTarget) {
  JointWorld world;
  world.gravity = {};
  const auto body = world.add_box(1, {0.3, 0.2, 0.1}, {0.15, 0, 0});
  const Quatd target = normalized(Quatd{0.3, -0.2, 0.4, 1});
  world.add_joint(joint::Ball{.spring = joint::RotationSpring{target, 0.05, 0.3}}, no_body, body, {});
  world.run(5);
  const Quatd q = world.bodies.pose[body].rotation * conjugate(target);
  EXPECT_LT(std::hypot(q.x, q.y, q.z), 1e-5);
}

}  // namespace souple::test_rigid_joint_motors
