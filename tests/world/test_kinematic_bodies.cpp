#include "tests/expect_error.h"
#include "tests/world/rigid_bodies.h"

#include <vector>

#include <gtest/gtest.h>

// Rigid bodies that prescribed motion moves.

namespace souple::test_world_kinematic_bodies {

TEST(KinematicBodies, ArriveAndPushOthers) {
  World world;
  world.add_collider(Plane{{0, 1, 0}, 0}, {.friction = 0});
  const ObjectId pusher = world.add_rigid_body(small_box, {.density = 1, .friction = 0}, at(0, 0.1, 0));
  const ObjectId crate = world.add_rigid_body(small_box, {.density = 5000, .friction = 0}, at(0.25, 0.1, 0));
  world.set_kinematic(pusher, true);
  EXPECT_TRUE(world.is_kinematic(pusher));
  EXPECT_FALSE(world.is_kinematic(crate));
  for (int frame = 1; frame <= 60; ++frame) {
    world.move_body(pusher, {{frame / 60.0, 0.1, 0}, {}, 1});
    world.step(1.0 / 60);
    EXPECT_LT(length(world.rigid_body(pusher).pose.translation - Vec3d{frame / 60.0, 0.1, 0}), 1e-9);
  }
  EXPECT_NEAR(world.rigid_body(pusher).velocity.x, 1, 1e-6);
  EXPECT_NEAR(world.rigid_body(crate).pose.translation.x, 1.2, 2e-3);
  EXPECT_NEAR(world.rigid_body(crate).velocity.x, 1, 0.02);
  EXPECT_EQ(world.kinetic_energy(pusher), 0);
  run(world, 0.5);  // without another call it stays
  EXPECT_LT(length(world.rigid_body(pusher).pose.translation - Vec3d{1, 0.1, 0}), 1e-9);
}

TEST(KinematicBodies, NothingPushesThem) {
  World world;
  const ObjectId table = world.add_rigid_body(small_box, {.density = 1}, at(0, 1, 0));
  world.set_kinematic(table, true);
  const ObjectId heavy = world.add_rigid_body(small_box, {.density = 20000}, at(0, 1.25, 0));
  const ObjectId cloth = world.add_cloth(grid(10, 10, 0.5), material::cotton, at(0, 1.6, 0));
  run(world, 2);
  EXPECT_LT(length(world.rigid_body(table).pose.translation - Vec3d{0, 1, 0}), 1e-12);
  EXPECT_NEAR(world.rigid_body(heavy).pose.translation.y, 1.2, 1e-3);
  EXPECT_GT(world.center_of_mass(cloth).y, 1.0);
}

TEST(KinematicBodies, FollowKeyframes) {
  World world;
  const ObjectId body = world.add_rigid_body(small_box, {}, at(1, 0, 0));
  const Quatd quarter = Quatd::from_axis_angle({0, 1, 0}, 3.14159265358979 / 2);
  const std::vector<PoseKey> keys{{0, {0, 0, 0}, {}}, {1, {0, 2, 0}, quarter}};
  world.set_motion(body, {.pose = ColliderMotion::keyframes(keys)});
  EXPECT_TRUE(world.is_kinematic(body));
  run(world, 0.5);
  RigidBodyState state = world.rigid_body(body);
  EXPECT_LT(length(state.pose.translation - Vec3d{std::sqrt(0.5), 1, -std::sqrt(0.5)}), 1e-6);
  EXPECT_NEAR(state.velocity.y, 2, 1e-3);
  EXPECT_NEAR(state.angular_velocity.y, 3.14159265358979 / 2, 1e-3);
  run(world, 1);
  state = world.rigid_body(body);
  EXPECT_LT(length(state.pose.translation - Vec3d{0, 2, -1}), 1e-6);
  EXPECT_LT(length(state.velocity), 1e-9);
  double largest = 0;
  for (const Vec3f& x : world.positions(body))
    largest = std::max(largest, length(Vec3d(x) - Vec3d{0, 2, -1}));
  EXPECT_NEAR(largest, 0.1 * std::sqrt(3.0), 1e-5);
}

TEST(KinematicBodies, GoOnAtTheirVelocityWhenTheyAreReleased) {
  World world = without_gravity();
  const ObjectId body = world.add_rigid_body(small_box);
  world.set_kinematic(body, true);
  for (int frame = 1; frame <= 30; ++frame) {
    world.move_body(body, {{frame / 20.0, 0, 0}, {}, 1});
    world.step(1.0 / 60);
  }
  world.set_kinematic(body, false);
  EXPECT_NEAR(world.rigid_body(body).velocity.x, 3, 1e-4);
  run(world, 0.5);
  EXPECT_NEAR(world.rigid_body(body).pose.translation.x, 3, 1e-3);
  world.set_kinematic(body, true);
  run(world, 0.5);
  EXPECT_NEAR(world.rigid_body(body).pose.translation.x, 3, 1e-3);
}

TEST(KinematicBodies, WakeWhatLiesOnThem) {
  World world;
  Settings settings = world.settings();
  settings.sleeping.enabled = true;
  world.set_settings(settings);
  const ObjectId table = world.add_rigid_body(Box{{}, {0.5f, 0.1f, 0.5f}}, {}, at(0, 0, 0));
  world.set_kinematic(table, true);
  const ObjectId crate = world.add_rigid_body(small_box, {}, at(0, 0.2, 0));
  run(world, 2);
  EXPECT_TRUE(world.is_asleep(crate));
  EXPECT_FALSE(world.is_asleep(table));
  for (int frame = 1; frame <= 60; ++frame) {
    world.move_body(table, {{0, frame / 120.0, 0}, {}, 1});
    world.step(1.0 / 60);
  }
  EXPECT_NEAR(world.rigid_body(crate).pose.translation.y, 0.7, 5e-3);
}

TEST(KinematicBodies, ASnapshotHoldsThem) {
  World world;
  world.add_collider(Plane{});
  const ObjectId body = world.add_rigid_body(small_box, {}, at(0, 0.1, 0));
  world.add_rigid_body(small_box, {}, at(0.25, 0.1, 0));
  const std::vector<PoseKey> keys{{0, {}, {}}, {1, {1, 0, 0}, {}}, {2, {0, 0, 0}, {}}};
  world.set_motion(body, {.pose = ColliderMotion::keyframes(keys, true)});
  run(world, 0.7);
  const Snapshot snapshot = world.snapshot();
  run(world, 2);
  const std::uint64_t hash = world.hash();
  world.restore(snapshot);
  run(world, 2);
  EXPECT_EQ(world.hash(), hash);
}

TEST(KinematicBodies, WhatDoesNotApplyIsRefusedInWords) {
  World world;
  const ObjectId body = world.add_rigid_body(small_box);
  const ObjectId cloth = world.add_cloth(grid(3, 3, 1));
  expect_error([&] { world.move_body(body, {}); }, {"set_kinematic"});
  expect_error([&] { world.set_kinematic(cloth, true); }, {"expected a rigid_body"});
  ObstacleMotion deforming;
  deforming.sequence.frames.push_back({});
  expect_error([&] { world.set_motion(body, deforming); }, {"does not deform"});
  world.set_kinematic(body, true);
  expect_error([&] { world.apply_impulse(body, Vec3f{1, 0, 0}, Vec3f{}); }, {"kinematic", "move_body"});
  expect_error([&] { world.apply_impulse(body, vertices({0}), {1, 0, 0}); }, {"kinematic"});
  expect_error([&] { world.set_body_velocity(body, {}, {}); }, {"kinematic"});
  world.teleport(body, {{0, 3, 0}, {}, 1});
  run(world, 0.1);
  EXPECT_LT(length(world.rigid_body(body).pose.translation - Vec3d{0, 3, 0}), 1e-9);
  world.set_motion(body, {.pose = ColliderMotion::callback([](double t) {
                            return Transform{{t, 0, 0}, {}, 1};
                          })});
  expect_error([&] { world.teleport(body, {}); }, {"set_motion"});
}

}  // namespace souple::test_world_kinematic_bodies
