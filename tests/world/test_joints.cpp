#include "souple/geometry/builders.h"
#include "souple/math/limits.h"
#include "souple/objects/joint_options.h"
#include "souple/rigid/joints/joint.h"
#include "souple/world/world.h"
#include "tests/expect_error.h"

#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace souple::test_world_joints {

ObjectOptions at(double x, double y, double z) {
  ObjectOptions options;
  options.transform.translation = {x, y, z};
  return options;
}

World on_the_ground(int threads = 1) {
  World world({.threads = threads});
  world.add_collider(Plane{});
  return world;
}

void run(World& world, double seconds) {
  for (int frame = 0; frame < seconds * 60; ++frame) world.step(1.0 / 60);
}

const Box brick{{}, {0.1f, 0.05f, 0.05f}};  // half extents

/// A chain of `count` bricks along x, hung by its first end from the origin, with a ball at the other end.
struct Chain {
  std::vector<JointId> joints;
  ObjectId ball;
};
Chain hang_chain(World& world, int count, float ball_density) {
  Chain chain;
  JointSide before;
  for (int i = 0; i < count; ++i) {
    const double x = 0.1 + 0.2 * i;
    const ObjectId link = world.add_rigid_body(brick, {}, at(x, 0, 0));
    chain.joints.push_back(
        world.add_joint(before, link, joint::Hinge{}, {.point = {x - 0.1, 0, 0}, .axis = {0, 0, 1}}));
    before = link;
  }
  chain.ball = world.add_rigid_body(Sphere{{}, 0.2f}, {.density = ball_density}, at(0.2 * count + 0.2, 0, 0));
  chain.joints.push_back(world.add_joint(before, chain.ball, joint::Ball{}, {.point = {0.2 * count, 0, 0}}));
  return chain;
}

double largest_error(const World& world) {
  double result = 0;
  for (const JointId id : world.joints()) result = std::max(result, world.joint_report(id).distance_error);
  return result;
}

TEST(WorldJoints, AMotionThatThrowsIsReported) {
  World world;
  const ObjectId box = world.add_rigid_body(brick, {}, at(8, 0, 0));
  world.add_joint({}, box, joint::Hinge{});
  world.add_collider(Sphere{}, {.motion = ColliderMotion::callback([](double) -> Transform {
                                  throw std::runtime_error("collider trouble");
                                })});
  for (int i = 0; i < 3; ++i)
    EXPECT_NE(world.step(1.0 / 60).message.find("collider trouble"), std::string::npos);
}

TEST(WorldJoints, BreakAtTheirForceAndSaySo) {
  World world;
  const ObjectId load = world.add_rigid_body(brick, {}, at(0, 0, 0));
  const double weight = world.rigid_body(load).mass * 9.81;
  const JointId holds =
      world.add_joint({}, load, joint::Fixed{}, {.name = "holds", .breaking_force = 1.02 * weight});
  run(world, 1);
  EXPECT_FALSE(world.joint_report(holds).broken);
  EXPECT_NEAR(length(world.joint_report(holds).force), weight, 0.001 * weight);
  const ObjectId more = world.add_rigid_body(brick, {.density = 35}, at(0, -0.3, 0));
  world.add_joint(load, more, joint::Distance{.shortest = 0.3, .longest = 0.3},
                  {.point_b = Vec3d{0, -0.3, 0}});
  std::size_t broken = 0;
  for (int frame = 0; frame < 60; ++frame) broken += world.step(1.0 / 60).broken_joints;
  EXPECT_EQ(broken, 1u);
  EXPECT_TRUE(world.joint_report(holds).broken);
  EXPECT_EQ(length(world.joint_report(holds).force), 0);
  EXPECT_LT(world.rigid_body(load).velocity.y, -5);
}

TEST(WorldJoints, WhatIsJoinedDoesNotCollideUntilTheJointIsRemoved) {
  World world;
  const ObjectId a = world.add_rigid_body(Sphere{{}, 0.2f}, {}, at(0, 0, 0));
  const ObjectId b = world.add_rigid_body(Sphere{{}, 0.2f}, {}, at(0.2, 0, 0));
  Settings settings = world.settings();
  settings.gravity = {};
  world.set_settings(settings);
  const JointId joint = world.add_joint(a, b, joint::Ball{}, {.point = {0.1, 0, 0}});
  run(world, 0.5);
  EXPECT_NEAR(length(world.rigid_body(a).pose.translation - world.rigid_body(b).pose.translation), 0.2, 1e-6);
  world.remove(joint);
  run(world, 1);
  EXPECT_GT(length(world.rigid_body(a).pose.translation - world.rigid_body(b).pose.translation), 0.39);
}

TEST(WorldJoints, AMotorTurnsAWheelAndCanBeChanged) {
  World world;
  const ObjectId wheel = world.add_rigid_body(Cylinder{{}, 0.3f, 0.05f}, {}, at(0, 2, 0));
  joint::Hinge hinge;
  hinge.rotation.motor = joint::Motor{.target = 4};
  const JointId drive = world.add_joint({}, wheel, hinge, {.point = {0, 2, 0}, .axis = {0, 1, 0}});
  run(world, 1);
  EXPECT_NEAR(world.rigid_body(wheel).angular_velocity.y, 4, 0.001);
  EXPECT_NEAR(world.joint_report(drive).coordinate[0], 4, 0.05);
  hinge.rotation.motor = joint::Motor{.kind = joint::Motor::Target::position, .target = 1};
  world.set_joint(drive, hinge);
  run(world, 2);
  EXPECT_NEAR(world.joint_report(drive).coordinate[0], 1, 0.001);
  EXPECT_NEAR(length(world.rigid_body(wheel).angular_velocity), 0, 0.001);
}

TEST(WorldJoints, AMovingColliderTakesABodyAlong) {
  World world;
  const auto motion = ColliderMotion::keyframes({{0, {0, 0, 0}, {}}, {1, {1, 0, 0}, {}}});
  const ColliderId crane = world.add_collider(Sphere{{}, 0.05f}, {.motion = motion});
  const ObjectId load = world.add_rigid_body(brick, {}, at(0, -1, 0));
  world.add_joint(crane, load, joint::Distance{.longest = 1}, {.point_b = Vec3d{0, -1, 0}});
  run(world, 1);
  EXPECT_GT(world.rigid_body(load).pose.translation.x, 0.3);
  EXPECT_LT(length(world.rigid_body(load).pose.translation - Vec3d{1, 0, 0}), 1.001);
}

// Planks between two banks, and a crate that lies on them.
TEST(WorldJoints, ABridgeCarriesACrate) {
  World world = on_the_ground();
  constexpr int planks = 8;
  JointSide before;
  for (int i = 0; i < planks; ++i) {
    const double x = -0.7 + 0.2 * i;
    const ObjectId plank = world.add_rigid_body(Box{{}, {0.095f, 0.02f, 0.3f}}, {}, at(x, 1, 0));
    const joint::Hinge hinge{
        .rotation = {.spring = joint::Spring{.compliance = joint::unlimited, .damping = 0.5}}};
    world.add_joint(before, plank, hinge, {.point = {x - 0.1, 1, 0}, .axis = {0, 0, 1}});
    before = plank;
  }
  // 5 % longer than straight, so that the planks hang through.
  world.add_joint(before, {}, joint::Distance{.longest = 0.08},
                  {.point = {0.8, 1, 0}, .point_b = Vec3d{0.86, 1, 0}});
  const ObjectId crate = world.add_rigid_body(Box{{}, {0.1f, 0.1f, 0.1f}}, {}, at(0, 1.13, 0));
  run(world, 8);
  const RigidBodyState state = world.rigid_body(crate);
  EXPECT_GT(state.pose.translation.y, 0.7);
  EXPECT_LT(state.pose.translation.y, 1.13);
  EXPECT_LT(length(state.velocity), 0.1);
  EXPECT_LT(world.report().deepest_contact, 2e-4);
  EXPECT_LT(largest_error(world), 1e-4 * 0.2);
}

TEST(WorldJoints, AnIslandOfJointsFallsAsleepTogether) {
  World world = on_the_ground();
  Settings settings = world.settings();
  settings.sleeping.enabled = true;
  world.set_settings(settings);
  const ObjectId a = world.add_rigid_body(brick, {}, at(0, 0.05, 0));
  const ObjectId b = world.add_rigid_body(brick, {}, at(5, 0.05, 0));
  world.add_joint(a, b, joint::Distance{.longest = 6}, {.point_b = Vec3d{5, 0.05, 0}});
  run(world, 3);
  EXPECT_TRUE(world.is_asleep(a));
  EXPECT_TRUE(world.is_asleep(b));
  world.wake(a);
  EXPECT_FALSE(world.is_asleep(b));
}

TEST(WorldJoints, ASnapshotHoldsThem) {
  World world({.threads = 1}), same({.threads = 8});
  hang_chain(world, 5, 700), hang_chain(same, 5, 700);
  run(world, 0.5), run(same, 0.5);
  EXPECT_EQ(world.hash(), same.hash());
  const Snapshot snapshot = world.snapshot();
  run(world, 0.5);
  World other;
  hang_chain(other, 5, 700);
  other.restore(snapshot);
  run(other, 0.5);
  EXPECT_EQ(world.hash(), other.hash());
  World without;
  hang_chain(without, 5, 700);
  without.remove(without.joints().back());
  expect_error([&] { without.restore(snapshot); }, {"other objects"});
}

TEST(WorldJoints, GoWithWhatTheyHold) {
  World world = on_the_ground();
  const Chain chain = hang_chain(world, 3, 700);
  const ColliderId hook = world.add_collider(Sphere{{0, 2, 0}, 0.1f});
  world.add_joint(hook, chain.ball, joint::Distance{.longest = 9}, {.name = "rope"});
  EXPECT_EQ(world.joints().size(), 5u);
  EXPECT_EQ(world.joint_report(world.find_joint("rope")).name, "rope");
  world.remove(hook);
  EXPECT_EQ(world.joints().size(), 4u);
  world.remove(chain.ball);
  EXPECT_EQ(world.joints().size(), 3u);
  expect_error([&] { (void)world.joint_report(chain.joints.back()); }, {"no joint has the handle"});
  expect_error([&] { (void)world.find_joint("hinge22"); }, {"hinge2"});
  run(world, 0.1);
}

TEST(WorldJoints, RefuseWhatTheyCannotHold) {
  World world;
  const ObjectId body = world.add_rigid_body(brick);
  const ObjectId cloth = world.add_cloth(grid(2, 2, 1), {}, {.name = "sheet"});
  const auto refused = [&](const JointSide& a, const JointSide& b, const joint::Kind& kind,
                           const JointOptions& options, const char* words) {
    expect_error([&] { world.add_joint(a, b, kind, options); }, {words});
  };
  refused({}, {}, joint::Ball{}, {}, "neither side is a rigid body");
  refused(body, body, joint::Ball{}, {}, "to itself");
  refused({}, cloth, joint::Ball{}, {.name = "seam"},
          "joint 'seam': sheet is a cloth, expected a rigid_body");
  refused({}, body, joint::Hinge{}, {.axis = {}}, "quaternion other than 0");
  refused({}, body, joint::Hinge{}, {.point = {NAN, 0, 0}}, "expected coordinates");
  refused({}, body, joint::Distance{.shortest = 2, .longest = 1}, {}, "shortest first");
  refused({}, body, joint::Universal{}, {.axis = {1, 0, 0}, .second_axis = Vec3d{2, 0, 0}}, "parallel");
  refused({}, body, joint::Fixed{}, {.breaking_force = 0}, "breaking_force");
  EXPECT_TRUE(world.joints().empty());
  const JointId joint = world.add_joint({}, body, joint::Ball{}, {.name = "one"});
  refused({}, body, joint::Ball{}, {.name = "one"}, "taken by another joint");
  expect_error([&] { world.set_joint(joint, joint::Hinge{}); }, {"is a ball joint, got a hinge"});
  expect_error([&] { world.set_joint(joint, joint::Ball{.max_swing = 4}); }, {"max_swing"});
}

}  // namespace souple::test_world_joints
