#include "tests/rigid/joint_world.h"

#include <cmath>

#include <gtest/gtest.h>

namespace souple::test_rigid_joints {

// Joints against closed forms.

using joint::Axis;
using joint::Ball;
using joint::Distance;
using joint::Fixed;
using joint::Hinge;
using joint::Pulley;
using joint::Slider;
using joint::Spring;
using joint::Universal;

constexpr double g = 9.81;

/// A rod that hangs from the origin on a hinge, let go at `amplitude`: its period by the closed one.
double pendulum_period(double amplitude, double l, JointWorld& world) {
  const double m = 2 * l * l * l, I = m / 12 * (l * l + 0.01 * l * l) + m * l * l / 4;
  const auto rod = world.add_box(m, {0.1 * l, l, 0.1 * l}, {});
  BodyPose& pose = world.bodies.pose[rod];
  pose.rotation = Quatd::from_axis_angle({0, 0, 1}, amplitude);
  pose.position = pose.direction({0, -l / 2, 0});
  world.add_joint(Hinge{}, no_body, rod, {}, {0, 0, 1});
  Crossings crossings;
  world.run(20 * std::sqrt(l), [&] { crossings.see(world.time, pose.position.x); });
  return crossings.period() / (4 * complete_elliptic(std::sin(amplitude / 2)) / std::sqrt(m * g * l / 2 / I));
}

TEST(Joints, APendulumSwingsWithItsPeriod) {
  for (const double l : {1.0, 100.0, 0.01})
    for (const double amplitude : {0.02, pi / 2}) {
      JointWorld world;
      EXPECT_NEAR(pendulum_period(amplitude, l, world), 1, 1e-3) << amplitude << " " << l;
      EXPECT_LT(world.worst.distance, 1e-6 * l) << l;
      EXPECT_LT(world.worst.angle, 1e-6) << l;
    }
}

TEST(Joints, ABodyFollowsOneThatNothingMoves) {
  JointWorld world;
  const auto driver = world.add_box(1, {1, 1, 1}, {}),
             follower = world.add_box(3, {0.5, 0.2, 0.2}, {1, 0, 0});
  world.add_joint(Fixed{}, driver, follower, {0.5, 0, 0});
  world.bodies.mass[driver] = {};
  world.bodies.velocity[driver] = {{1, 0, 0}, {0, 2, 0}};
  world.run(3);
  EXPECT_NEAR(world.bodies.pose[driver].position.x, 3, 1e-9);
  EXPECT_LT(length(world.bodies.pose[follower].position - world.bodies.pose[driver].point({1, 0, 0})), 1e-6);
  EXPECT_LT(world.worst.distance, 2e-6);
}

TEST(Joints, APendulumSwingsAsHighAfterAMinute) {
  JointWorld world;
  const auto rod = world.add_box(2, {1, 0.1, 0.1}, {0.5, 0, 0});
  world.add_joint(Hinge{}, no_body, rod, {}, {0, 0, 1});
  world.run(55);
  double highest = -1;
  world.run(5, [&] { highest = std::max(highest, world.bodies.pose[rod].position.y); });
  EXPECT_NEAR(highest, 0, 0.005);
}

TEST(Joints, ADoublePendulumKeepsItsEnergy) {
  JointWorld world;
  const auto upper = world.add_box(1, {1, 0.1, 0.1}, {0.5, 0, 0}),
             lower = world.add_box(1, {1, 0.1, 0.1}, {1.5, 0, 0});
  world.add_joint(Hinge{}, no_body, upper, {}, {0, 0, 1});
  world.add_joint(Hinge{}, upper, lower, {1, 0, 0}, {0, 0, 1});
  const double start = world.energy(), above_lowest = g * (0.5 + 1.5);
  double worst = 0;
  world.run(10, [&] { worst = std::max(worst, std::abs(world.energy() - start)); });
  EXPECT_LT(worst, 0.01 * above_lowest);
  EXPECT_LT(world.worst.distance, 1e-6);
}

/// Two tumbling boxes that share a point.
void add_tumbling_pair(JointWorld& world, const joint::Kind& kind) {
  world.gravity = {};
  const auto a = world.add_box(1, {0.3, 0.2, 0.1}, {0, 0, 0}),
             b = world.add_box(3, {0.1, 0.4, 0.2}, {0.3, 0.2, 0});
  const Vec3d point{0.15, 0.1, 0};
  world.bodies.velocity[a] = {{1, 0, 0.5}, {1, 2, 3}};
  const Vec3d v = world.bodies.velocity[a].at(point);
  world.bodies.velocity[b].angular = std::holds_alternative<Ball>(kind) ? Vec3d{-4, 1, 2} : Vec3d{1, 2, 3};
  world.bodies.velocity[b].linear = v - cross(world.bodies.velocity[b].angular, point - Vec3d{0.3, 0.2, 0});
  world.add_joint(kind, a, b, point);
}

TEST(Joints, FreeBodiesKeepTheirMomentum) {
  for (const joint::Kind& kind :
       {joint::Kind{Ball{}}, joint::Kind{Fixed{}}, joint::Kind{Hinge{}}, joint::Kind{Slider{}}}) {
    JointWorld world;
    add_tumbling_pair(world, kind);
    const Vec3d p = world.momentum(), L = world.angular_momentum();
    const double energy = world.energy();
    double linear = 0, angular = 0;
    world.run(10, [&] {
      linear = std::max(linear, length(world.momentum() - p) / length(p));
      angular = std::max(angular, length(world.angular_momentum() - L) / length(L));
    });
    EXPECT_LT(linear, 1e-10) << kind.index();
    EXPECT_LT(angular, 1e-5) << kind.index();
    EXPECT_NEAR(world.energy() / energy, 1, 1e-2) << kind.index();
    EXPECT_LT(world.worst.distance, 1e-5) << kind.index();
    EXPECT_LT(world.worst.angle, 1e-5) << kind.index();
  }
}

TEST(Joints, FurtherProjectionsOfASubstepChangeNothing) {
  JointWorld once, often;
  often.iterations = 4;
  for (JointWorld* world : {&once, &often}) {
    add_tumbling_pair(*world, Ball{.max_swing = 2, .twist = {-1, 1}});
    world->add_joint(Distance{.shortest = 0.3, .longest = 0.3, .compliance = 1e-4}, no_body, 0, {0, 0.3, 0});
    world->joints.joint[1].frame_b = {};
    world->run(1);
  }
  EXPECT_LT(length(once.bodies.pose[1].position - often.bodies.pose[1].position), 1e-4);
}

/// Period, and amplitude after `seconds` relative to the first, of a box on a slider with a spring.
std::pair<double, double> slide(double omega, double damping, double seconds) {
  JointWorld world;
  const double m = 2;
  const auto box = world.add_box(m, {0.2, 0.2, 0.2}, {0.1, 0, 0});
  joint::Joint slider{.name = "slider", .b = box};
  slider.kind = Slider{.translation = Axis{.spring = Spring{0, 1 / (m * omega * omega), damping}}};
  slider.frame_b.rotation = {};
  add(world.joints, slider, world.bodies.size());
  Crossings crossings;
  double last = 0;
  world.run(seconds, [&] {
    const double x = world.bodies.pose[box].position.x;
    crossings.see(world.time, x);
    if (world.time > seconds - 2 * pi / omega) last = std::max(last, std::abs(x));
  });
  EXPECT_LT(world.worst.distance, 2e-5);
  return {crossings.period(), last / 0.1};
}

TEST(Joints, ASpringOnASliderSwingsWithItsPeriodAndDecaysAsItsDampingSays) {
  for (const double omega : {3.0, 10.0, 60.0}) {
    const auto [period, amplitude] = slide(omega, 0, 20);
    EXPECT_NEAR(period * omega / (2 * pi), 1, 2e-3) << omega;
    EXPECT_NEAR(amplitude, 1, 0.01) << omega;
    const double damping = 0.8, rate = damping / (2 * 2), seconds = 10;  // of 2 kg
    const auto [damped_period, damped] = slide(omega, damping, seconds);
    EXPECT_NEAR(damped_period * std::sqrt(omega * omega - rate * rate) / (2 * pi), 1, 2e-3) << omega;
    // The first maximum of the last period.
    EXPECT_GT(damped, 0.98 * std::exp(-rate * seconds)) << omega;
    EXPECT_LT(damped, 1.02 * std::exp(-rate * (seconds - 2 * pi / omega))) << omega;
  }
}

TEST(Joints, ASpringTooStiffForSubstepsComesToRest) {
  const auto [period, amplitude] = slide(5000, 0, 1);
  EXPECT_LT(amplitude, 1e-3);
}

TEST(Joints, ADamperSlowsExponentially) {
  JointWorld world;
  world.gravity = {};
  const auto box = world.add_box(2, {0.2, 0.2, 0.2}, {});
  world.add_joint(Slider{.translation = Axis{.spring = Spring{0, joint::unlimited, 40}}}, no_body, box, {});
  world.bodies.velocity[box].linear = {1, 0, 0};
  world.run(0.2);
  EXPECT_NEAR(world.bodies.velocity[box].linear.x / std::exp(-40.0 / 2 * 0.2), 1, 0.02);
}

TEST(Joints, AStrongDamperSlowsAFallToItsTerminalSpeed) {
  JointWorld world;
  const auto box = world.add_box(2, {0.2, 0.2, 0.2}, {});
  world.add_joint(Slider{.translation = Axis{.spring = Spring{0, joint::unlimited, 400}}}, no_body, box, {},
                  {0, -1, 0});
  world.run(1);
  EXPECT_NEAR(world.bodies.velocity[box].linear.y, -2 * g / 400, 1e-6);
}

TEST(Joints, ABallJointStopsAtItsSwingAndTwist) {
  JointWorld world;
  world.gravity = {3, -9.81, 1};
  const auto rod = world.add_box(1, {1, 0.1, 0.2}, {0.5, 0, 0});
  const auto j = world.add_joint(Ball{.max_swing = 0.5, .twist = {-0.3, 0.2}}, no_body, rod, {});
  world.torque[rod] = {2, 0, 0};
  double most_swing = 0, most_twist = 0, least_twist = 0;
  const auto see = [&] {
    const joint::Ends ends = ends_of(world.joints.joint[j], world.joints.state[j], world.bodies);
    const double twist = joint::twist_row(ends).value;
    most_swing = std::max(most_swing, joint::swing_row(ends).value);
    most_twist = std::max(most_twist, twist), least_twist = std::min(least_twist, twist);
  };
  world.run(2, see);
  world.torque[rod] = {-2, 0, 0};
  world.gravity = {-1, 9.81, 2};
  world.run(2, see);
  EXPECT_NEAR(most_swing, 0.5, 1e-3);
  EXPECT_NEAR(most_twist, 0.2, 1e-3);
  EXPECT_NEAR(least_twist, -0.3, 1e-3);
  EXPECT_LT(world.worst.distance, 1e-5);
}

TEST(Joints, AHingeStopsAtItsLimitAfterFullTurns) {
  JointWorld world;
  world.gravity = {};
  const auto rod = world.add_box(1, {1, 0.1, 0.2}, {0.5, 0, 0});
  const auto j =
      world.add_joint(Hinge{.rotation = Axis{.limits = {-0.5, 6 * pi + 0.25}}}, no_body, rod, {}, {0, 0, 1});
  world.torque[rod] = {0, 0, 1};
  double most = 0;
  world.run(20, [&] {
    most = std::max(most, hinge_angle(ends_of(world.joints.joint[j], world.joints.state[j], world.bodies)));
  });
  EXPECT_NEAR(most, 6 * pi + 0.25, 1e-3);
  EXPECT_NEAR(world.joints.state[j].angle[0], 6 * pi + 0.25, 1e-3);
  EXPECT_NEAR(world.joints.state[j].torque.z, -1, 1e-6);
}

TEST(Joints, AWeldReportsTheForceAndTorqueOfACantilever) {
  JointWorld world;
  const auto beam = world.add_box(2, {1, 0.1, 0.1}, {0.5, 0, 0});
  const auto j = world.add_joint(Fixed{}, no_body, beam, {});
  world.run(0.2);
  EXPECT_LT(length(world.joints.state[j].force - Vec3d{0, 2 * g, 0}), 1e-4 * 2 * g);
  EXPECT_LT(length(world.joints.state[j].torque - Vec3d{0, 0, 2 * g * 0.5}), 1e-4 * g);
  world.h = 1.0 / 1000;  // impulses are no forces
  world.step();
  EXPECT_LT(length(world.joints.state[j].force - Vec3d{0, 2 * g, 0}), 1e-2 * 2 * g);
}

TEST(Joints, AJointBreaksAtItsForceAndAtItsTorque) {
  JointWorld pulled;
  pulled.gravity = {};
  const auto box = pulled.add_box(2, {0.2, 0.2, 0.2}, {});
  const auto j = pulled.add_joint(Fixed{}, no_body, box, {0.1, 0, 0});
  pulled.joints.joint[j].breaking_force = 100;
  for (; !pulled.joints.state[j].broken && pulled.time < 20; pulled.step())
    pulled.force[box] = {10 * pulled.time, 0, 0};
  EXPECT_NEAR(pulled.force[box].x, 100, 1);
  const double broken = pulled.time;
  pulled.run(0.5);
  EXPECT_NEAR(pulled.bodies.velocity[box].linear.x, pulled.force[box].x / 2 * (pulled.time - broken), 1);

  JointWorld twisted;
  twisted.gravity = {};
  const auto beam = twisted.add_box(2, {1, 0.1, 0.1}, {0.5, 0, 0});
  const auto k = twisted.add_joint(Fixed{}, no_body, beam, {});
  twisted.joints.joint[k].breaking_torque = 10;
  for (; !twisted.joints.state[k].broken && twisted.time < 30; twisted.step())
    twisted.torque[beam] = {twisted.time, 0, 0};
  EXPECT_NEAR(twisted.torque[beam].x, 10, 0.1);
}

TEST(Joints, AtwoodsMachineAcceleratesAsItsMassesSay) {
  for (const double ratio : {1.0, 2.0}) {
    JointWorld world;
    const double ma = 1, mb = 3;
    const auto a = world.add_box(ma, {0.1, 0.1, 0.1}, {-0.5, -3, 0}),
               b = world.add_box(mb, {0.1, 0.1, 0.1}, {0.5, -1, 0});
    world.add_joint(Pulley{{-0.5, 0, 0}, {0.5, 0, 0}, ratio, 3 + ratio}, a, b, {});
    for (joint::Frame* frame : {&world.joints.joint[0].frame_a, &world.joints.joint[0].frame_b}) *frame = {};
    world.run(0.5);
    // Down at b, for T at a and ratio T at b.
    const double acceleration = g * (mb - ratio * ma) / (mb + ratio * ratio * ma);
    EXPECT_NEAR(world.bodies.velocity[b].linear.y / (-0.5 * acceleration), 1, 5e-3) << ratio;
    EXPECT_NEAR(world.bodies.velocity[a].linear.y / (0.5 * ratio * acceleration), 1, 5e-3) << ratio;
    EXPECT_NEAR(length(world.joints.state[0].force) / (ratio * ma * (g + ratio * acceleration)), 1, 5e-3)
        << ratio;
    EXPECT_LT(world.worst.distance, 1e-5) << ratio;
  }
}

TEST(Joints, ARopeOnlyPulls) {
  JointWorld world;
  const auto box = world.add_box(1, {0.1, 0.1, 0.1}, {0, -0.5, 0});
  const auto j = world.add_joint(Distance{.shortest = 0, .longest = 1}, no_body, box, {});
  world.joints.joint[j].frame_b = {};
  world.run(0.3);
  EXPECT_NEAR(world.bodies.pose[box].position.y, -0.5 - g * 0.09 / 2, 0.01);
  EXPECT_EQ(length(world.joints.state[j].force), 0);
  world.run(1);
  EXPECT_NEAR(world.bodies.pose[box].position.y, -1, 1e-6);
  EXPECT_NEAR(world.joints.state[j].force.y, g, 1e-3 * g);
}

/// Two shafts at an angle, each in its own bearing, joined by a universal joint: tan(second) = tan(first) / cos(angle)
/// or times cos(angle), by where the first one begins.
TEST(Joints, AUniversalJointTurnsTheSecondShaftAsCardanSays) {
  const double angle = 0.5;
  JointWorld world;
  world.gravity = {};
  const Vec3d along{std::cos(angle), std::sin(angle), 0};
  const auto first = world.add_box(1, {1, 0.1, 0.1}, {-0.5, 0, 0}),
             second = world.add_box(1, {1, 0.1, 0.1}, {});
  world.bodies.pose[second] = {along * 0.5, Quatd::from_axis_angle({0, 0, 1}, angle)};
  world.bodies.start[second] = world.bodies.pose[second];
  world.add_joint(Hinge{.rotation = Axis{.motor = joint::Motor{.target = 2}}}, no_body, first, {-1, 0, 0});
  world.add_joint(Hinge{}, no_body, second, along, along);
  joint::Joint cardan{.name = "cardan", .a = first, .b = second, .kind = Universal{}};
  // The cross: its arm on the first shaft along y, its arm on the second one along z.
  const Quatd across = Quatd::from_axis_angle({0, 0, 1}, pi / 2);
  cardan.frame_a = {{0.5, 0, 0}, across}, cardan.frame_b = {{-0.5, 0, 0}, across};
  add(world.joints, cardan, world.bodies.size());
  double worst = 0;
  world.run(5, [&] {
    const double in = world.joints.state[0].angle[0], out = world.joints.state[1].angle[0];
    worst = std::max(worst,
                     std::abs(std::sin(out) * std::cos(in) * std::cos(angle) - std::sin(in) * std::cos(out)));
  });
  EXPECT_GT(world.joints.state[1].angle[0], 9);
  EXPECT_LT(worst, 1e-3);
  EXPECT_LT(world.worst.distance, 1e-4);
  EXPECT_LT(world.worst.angle, 1e-4);
}

// A horizontal top in steady precession, W = m g l / (I_3 w_3): Goldstein, "Classical Mechanics", section 5.7.
TEST(Joints, AHeavySymmetricTopPrecesses) {
  JointWorld world;
  const double m = 1, l = 0.1, spin = 100, moment = 0.002;
  const std::uint32_t top = world.add_body(m, {moment, 0.0012, 0.0012}, {l, 0, 0});
  world.add_joint(joint::Ball{}, no_body, top, {});
  const double precession = m * 9.81 * l / (moment * spin);
  world.bodies.velocity[top] = {{0, 0, -precession * l}, {spin, precession, 0}};
  double turned = 0, before = 0;
  world.run(3, [&] {
    const Vec3d x = world.bodies.pose[top].position;
    const double angle = std::atan2(-x.z, x.x);
    turned += std::remainder(angle - before, 2 * pi), before = angle;
    EXPECT_LT(std::abs(x.y), 0.02 * l);
  });
  EXPECT_NEAR(turned, precession * 3, 0.02 * precession * 3);
  EXPECT_LT(world.worst.distance, 1e-4 * l);
}

using joint::Motor;

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

/// A horizontal chain of `count` links on hinges from the origin, with a ball of `load` kg at its end. Links of 1 kg.
std::uint32_t add_chain(JointWorld& world, int count, double link, double load) {
  std::uint32_t before = no_body;
  for (int i = 0; i < count; ++i) {
    const auto body = world.add_box(1, {link, link / 4, link / 4}, {link * (i + 0.5), 0, 0});
    world.add_joint(Hinge{}, before, body, {link * i, 0, 0}, {0, 0, 1});
    before = body;
  }
  const double r = 0.3, I = 0.4 * load * r * r;
  const auto ball = world.add_body(load, {I, I, I}, {link * count + r, 0, 0});
  world.add_joint(Hinge{}, before, ball, {link * count, 0, 0}, {0, 0, 1});
  return ball;
}

/// Sum of all gaps, relative to the chain's length.
double stretch_of(const JointWorld& world, double length) {
  double sum = 0;
  for (std::size_t j = 0; j < world.joints.size(); ++j)
    sum += error_of(world.joints.joint[j], world.joints.state[j], world.bodies).distance;
  return sum / length;
}

TEST(JointChain, AHundredHingesCarryAThousandTimesALinksMass) {
  for (const double link : {0.1, 0.02}) {
    JointWorld world;
    const auto ball = add_chain(world, 100, link, 1000);
    const double start = world.energy();
    double stretch = 0, most_energy = -1e300;
    world.run(6, [&] {
      stretch = std::max(stretch, stretch_of(world, 100 * link));
      most_energy = std::max(most_energy, world.energy() - start);
    });
    EXPECT_LT(stretch, 3e-5) << link;
    EXPECT_LT(most_energy, 0.001 * 1000 * g * 100 * link) << link;
    EXPECT_LT(length(world.bodies.pose[ball].position), 100 * link + 0.301) << link;
  }
}

TEST(JointChain, AWhipHoldsTogether) {
  JointWorld world;
  add_chain(world, 100, 0.1, 1);
  const double start = world.energy();
  double stretch = 0, most_energy = -1e300;
  world.run(6, [&] {
    stretch = std::max(stretch, stretch_of(world, 10));
    most_energy = std::max(most_energy, world.energy() - start);
  });
  EXPECT_LT(stretch, 1e-6);
  EXPECT_LT(most_energy, 0.01 * 100 * g * 5);
}

/// A folded chain of 20 links, with a ball beside its first hinge: the ball falls, and jerks it taut. The largest rise of
/// the energy, relative to that of the fall.
double rise_after_jerk(double load, double speed) {
  JointWorld world;
  const double link = 0.1, r = 0.14;
  Vec3d end;
  std::uint32_t before = no_body;
  for (int i = 0; i < 20; ++i) {
    const double angle = i % 2 == 0 ? -1.3 : 1.3;
    const Vec3d along{std::cos(angle), std::sin(angle), 0};
    const auto body = world.add_box(1, {link, link / 4, link / 4}, end + along * (link / 2));
    world.bodies.pose[body].rotation = Quatd::from_axis_angle({0, 0, 1}, angle);
    world.add_joint(Hinge{}, before, body, end, {0, 0, 1});
    end += along * link, before = body;
  }
  const double I = load * r * r;
  const auto ball = world.add_body(load, {I, I, I}, end);
  world.add_joint(joint::Ball{}, before, ball, end);
  world.bodies.velocity[ball].linear = {0, -speed, 0};
  double lowest = world.energy(), rise = 0;
  world.run(3, [&] {
    lowest = std::min(lowest, world.energy());
    rise = std::max(rise, world.energy() - lowest);
  });
  EXPECT_LT(stretch_of(world, 2), 1e-4) << load << " " << speed;
  return rise / (load * (g * 2 + speed * speed / 2));
}

TEST(JointChain, AJerkGivesLittleEnergyBack) {
  for (const double speed : {5.0, 20.0}) {
    EXPECT_LT(rise_after_jerk(30, speed), 0.01) << speed;
    EXPECT_LT(rise_after_jerk(1000, speed), 0.1) << speed;
  }
}

/// A straight chain between two banks that have to come nearer: no gradient shows the way, and a lorry is on it.
TEST(JointChain, AStraightChainThatHasToBecomeShorterDoesNotExplode) {
  JointWorld world;
  const int planks = 30;
  std::uint32_t before = no_body;
  for (int i = 0; i < planks; ++i) {
    const auto plank = world.add_box(i == 11 ? 1000 : 1, {0.5, 0.05, 1}, {0.5 * i + 0.25, 0, 0});
    world.add_joint(Hinge{}, before, plank, {0.5 * i, 0, 0}, {0, 0, 1});
    before = plank;
  }
  joint::Joint bank{.name = "bank", .a = before, .kind = Hinge{}};
  place(bank, world.bodies, {0.5 * planks, 0, 0}, joint::axes_along({0, 0, 1}));
  bank.frame_b.point.x -= 0.75;
  add(world.joints, bank, world.bodies.size());
  double fastest = 0;
  world.run(3, [&] {
    for (const BodyVelocity& v : world.bodies.velocity) fastest = std::max(fastest, length(v.linear));
  });
  EXPECT_LT(fastest, 100);
  EXPECT_LT(stretch_of(world, 0.5 * planks), 1e-6);
}

/// Rope of links and a ball as a pendulum: it swings, as a whole, with the period of its length.
TEST(JointChain, ALoadedChainSwingsAsAPendulum) {
  JointWorld world;
  const auto ball = add_chain(world, 20, 0.1, 1000);
  const double angle = 0.1;
  for (std::size_t i = 0; i < world.bodies.size(); ++i) {
    BodyPose& pose = world.bodies.pose[i];
    const Quatd turn = Quatd::from_axis_angle({0, 0, 1}, angle - pi / 2);
    pose = {rotate(turn, pose.position), turn};
  }
  Crossings crossings;
  double last = 0;
  world.run(20, [&] {
    const double x = world.bodies.pose[ball].position.x;
    crossings.see(world.time, x);
    if (world.time > 17) last = std::max(last, x);
  });
  // The ball does not rotate against the last link when all hang straight: a physical pendulum of the whole.
  double first = 0, second = 0;
  for (std::size_t i = 0; i < world.bodies.size(); ++i) {
    const double m = 1 / world.bodies.mass[i].inverse,
                 l = i < 20 ? 0.1 * (static_cast<double>(i) + 0.5) : 2.3;
    first += m * l, second += m * l * l;
  }
  EXPECT_NEAR(crossings.period() / (2 * pi * std::sqrt(second / first / g)), 1, 0.02);
  EXPECT_NEAR(last, 2.3 * std::sin(angle), 0.05 * 2.3 * std::sin(angle));
}

/// A bridge of planks that begins as a V, with dampers in its hinges.
TEST(JointChain, ABridgeBetweenTwoBanksCarriesALorry) {
  JointWorld world;
  const int planks = 30;
  const double slope = 0.3, length = 0.5;
  const Hinge hinge{.rotation = {.spring = joint::Spring{0, joint::unlimited, 200}}};
  Vec3d end;
  std::uint32_t before = no_body;
  for (int i = 0; i < planks; ++i) {
    const double angle = i < planks / 2 ? -slope : slope;
    const Vec3d along{std::cos(angle), std::sin(angle), 0};
    const auto plank = world.add_box(i == 11 ? 1000 : 1, {length, 0.05, 1}, end + along * (length / 2));
    world.bodies.pose[plank].rotation = Quatd::from_axis_angle({0, 0, 1}, angle);
    world.add_joint(hinge, before, plank, end, {0, 0, 1});
    end += along * length, before = plank;
  }
  world.add_joint(hinge, before, no_body, end, {0, 0, 1});
  world.run(12);
  EXPECT_LT(world.worst.distance, 1e-5);
  // Forces on b: the first plank, and the bank.
  const Vec3d first = world.joints.state.front().force, last = world.joints.state.back().force;
  EXPECT_NEAR((first.y - last.y) / (1029 * g), 1, 1e-3);
  EXPECT_NEAR(first.x / last.x, 1, 1e-3);
  EXPECT_GT(std::abs(first.x), 1000);
}

TEST(JointChain, ADoorOnTwoHingesAndAParallelogramHold) {
  JointWorld door;
  const auto leaf = door.add_box(20, {0.8, 2, 0.04}, {0.4, 1, 0});
  for (const double height : {0.2, 1.8}) door.add_joint(Hinge{}, no_body, leaf, {0, height, 0}, {0, 1, 0});
  door.bodies.velocity[leaf] = {{0, 0, -0.4}, {0, 1, 0}};
  door.run(1);
  EXPECT_NEAR(door.joints.state[0].angle[0], 1, 0.01);
  EXPECT_LT(door.worst.distance, 1e-5);
  EXPECT_NEAR(door.joints.state[0].force.y + door.joints.state[1].force.y, 20 * g, 0.01 * 20 * g);

  JointWorld linkage;
  const auto left = linkage.add_box(1, {0.05, 1, 0.05}, {0, 0.5, 0}),
             right = linkage.add_box(1, {0.05, 1, 0.05}, {2, 0.5, 0}),
             top = linkage.add_box(1, {2, 0.05, 0.05}, {1, 1, 0});
  linkage.add_joint(Hinge{}, no_body, left, {0, 0, 0}, {0, 0, 1});
  linkage.add_joint(Hinge{}, no_body, right, {2, 0, 0}, {0, 0, 1});
  linkage.add_joint(Hinge{}, left, top, {0, 1, 0}, {0, 0, 1});
  linkage.add_joint(Hinge{}, right, top, {2, 1, 0}, {0, 0, 1});
  linkage.bodies.velocity[left] = linkage.bodies.velocity[right] = {{0.5, 0, 0}, {0, 0, -1}};
  linkage.bodies.velocity[top] = {{1, 0, 0}, {}};
  const double energy = linkage.energy();
  linkage.run(3);
  EXPECT_LT(linkage.worst.distance, 1e-4);
  EXPECT_NEAR(linkage.energy(), energy, 0.02 * 2 * g * 2);
  EXPECT_LT(length(cross(linkage.bodies.pose[top].direction({1, 0, 0}), Vec3d{1, 0, 0})), 1e-3);
}

TEST(JointChain, SweepsStayCalmAtAnyMassRatio) {
  for (const double load : {1.0, 1000.0}) {
    JointWorld world;
    world.solver.method = joint::Method::sweep;
    add_chain(world, 50, 0.1, load);
    const double start = world.energy();
    double most_energy = -1e300;
    world.run(4, [&] { most_energy = std::max(most_energy, world.energy() - start); });
    EXPECT_LT(most_energy, 0.01 * load * g * 5) << load;
  }
}

}  // namespace souple::test_rigid_joints
