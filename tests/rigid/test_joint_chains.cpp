#include "tests/rigid/joint_world.h"

#include <cmath>

#include <gtest/gtest.h>

namespace souple::test_rigid_joint_chains {

using joint::Hinge;

constexpr double g = 9.81;

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

}  // namespace souple::test_rigid_joint_chains
