#include "tests/expect_error.h"
#include "tests/world/rigid_bodies.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace souple::test_world_rigid_bodies {

World on_the_ground(int threads = 1) {
  World world;
  Settings settings = world.settings();
  settings.threads = threads;
  world.set_settings(settings);
  world.add_collider(Plane{});
  return world;
}

TEST(RigidBodies, HaveTheMassOfTheirShape) {
  World world;
  const RigidBodyMaterial material{.density = 500};
  const ObjectId box = world.add_rigid_body(small_box, material, at(1, 2, 3));
  const RigidBodyState state = world.rigid_body(box);
  EXPECT_NEAR(state.mass, 4, 1e-6);
  EXPECT_NEAR(state.inertia.x, 4 * 0.04 / 6, 1e-8);
  EXPECT_NEAR(length(state.pose.translation - Vec3d{1, 2, 3}), 0, 1e-9);
  EXPECT_NEAR(world.total_mass(box), 4, 1e-5);
  const ObjectId ball = world.add_rigid_body(Sphere{{0, 1, 0}, 0.5f}, material);
  EXPECT_NEAR(world.rigid_body(ball).mass, 500 * 3.14159265 / 6, 1e-3);
  EXPECT_NEAR(world.rigid_body(ball).pose.translation.y, 1, 1e-9);
}

TEST(RigidBodies, AStackStandsAndFallsAsleep) {
  World world = on_the_ground();
  Settings settings = world.settings();
  settings.sleeping.enabled = true;
  world.set_settings(settings);
  std::vector<ObjectId> boxes;
  boxes.reserve(5);
  for (int i = 0; i < 5; ++i) boxes.push_back(world.add_rigid_body(small_box, {}, at(0, 0.1 + 0.2 * i, 0)));
  run(world, 2);
  for (int i = 0; i < 5; ++i) {
    const Vec3d center = world.rigid_body(boxes[static_cast<std::size_t>(i)]).pose.translation;
    EXPECT_LT(length(center - Vec3d{0, 0.1 + 0.2 * i, 0}), 1e-3) << i;
    EXPECT_TRUE(world.is_asleep(boxes[static_cast<std::size_t>(i)])) << i;
  }
}

TEST(RigidBodies, ACardHouseAndAWallFallAsleep) {
  World world = on_the_ground();
  Settings settings = world.settings();
  settings.sleeping.enabled = true;
  world.set_settings(settings);
  std::vector<ObjectId> bodies;
  // Cards of 14 cm that lean against each other by 0.35 rad.
  for (const int side : {-1, 1}) {
    ObjectOptions options = at(side * 0.024943, 0.066099, 0);
    options.transform.rotation = Quatd::from_axis_angle({0, 0, 1}, side * 0.35);
    bodies.push_back(world.add_rigid_body(Box{{}, {0.001f, 0.07f, 0.05f}}, {}, options));
  }
  for (int layer = 0; layer < 6; ++layer)
    for (int k = 0; k < 4; ++k)
      bodies.push_back(world.add_rigid_body(Box{{}, {0.2f, 0.1f, 0.1f}}, {},
                                            at(2 + 0.402 * k + 0.19 * (layer % 2), 0.1 + 0.2 * layer, 0)));
  run(world, 3);
  for (const ObjectId body : bodies) EXPECT_TRUE(world.is_asleep(body)) << body.value;
  EXPECT_NEAR(world.rigid_body(bodies[0]).pose.translation.y, 0.066099, 1e-4);
  EXPECT_NEAR(world.rigid_body(bodies.back()).pose.translation.y, 1.1, 1e-4);
}

TEST(RigidBodies, TheirVerticesMoveWithThem) {
  World world;
  ObjectOptions options = at(0, 5, 0);
  options.velocity = {1, 2, 0}, options.angular_velocity = {0, 3, 1};
  const ObjectId body = world.add_rigid_body(box({0.4, 0.2, 0.6}, 2), {}, options);
  run(world, 0.5);
  const RigidBodyState state = world.rigid_body(body);
  EXPECT_NEAR(state.pose.translation.y, 5 + 1 - 9.81 / 8, 0.01);
  const auto x = world.positions(body);
  double size = 0;
  for (std::size_t i = 0; i < x.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) size = std::max(size, length(Vec3d(x[i]) - Vec3d(x[j])));
  EXPECT_NEAR(size, std::sqrt(0.16 + 0.04 + 0.36), 1e-5);
  Vec3d mean;
  for (const Vec3f& p : x) mean += Vec3d(p) / static_cast<double>(x.size());
  EXPECT_LT(length(mean - state.pose.translation), 1e-5);
}

TEST(RigidBodies, LieOnASoftBodyThatCarriesThem) {
  World world = on_the_ground();
  const ObjectId soft =
      world.add_soft_body(tet_bar(6, 3, 6, {0.8, 0.4, 0.8}), material::rubber, at(0, 0.21, 0));
  const ObjectId body = world.add_rigid_body(small_box, {}, at(0, 0.56, 0));
  run(world, 2);
  const RigidBodyState state = world.rigid_body(body);
  EXPECT_NEAR(state.pose.translation.y, 0.5, 0.01);
  EXPECT_LT(length(state.velocity), 0.02);
  EXPECT_LT(world.center_of_mass(soft).y, 0.21);
}

TEST(RigidBodies, FloatAsDeepAsTheirDensitySays) {
  World world = on_the_ground();
  std::vector<Vec3d> water;
  const double d = 0.05;
  for (int i = 0; i < 16; ++i)
    for (int j = 0; j < 8; ++j)
      for (int k = 0; k < 16; ++k) water.push_back({(i - 7.5) * d, (j + 0.5) * d, (k - 7.5) * d});
  FluidMaterial material = material::water;
  material.spacing = static_cast<float>(d);
  world.add_fluid(water, material);
  for (const Vec3f& n : {Vec3f{1, 0, 0}, Vec3f{-1, 0, 0}, Vec3f{0, 0, 1}, Vec3f{0, 0, -1}})
    world.add_collider(Plane{n, -0.4f});
  const ObjectId body = world.add_rigid_body(box({0.3, 0.3, 0.3}, 5), {.density = 500}, at(0, 0.5, 0));
  run(world, 3);
  // Half of it is under the surface, which it raises by its displaced volume.
  const double level = 0.4 + 0.5 * 0.027 / 0.64;
  EXPECT_NEAR(world.rigid_body(body).pose.translation.y, level, 0.03);
}

TEST(RigidBodies, MomentumStaysWhereABodyHitsACloth) {
  World world;
  Settings settings = world.settings();
  settings.gravity = {}, settings.wind.air_density = 0;
  world.set_settings(settings);
  const ObjectId cloth = world.add_cloth(grid(16, 16, 1), material::denim, at(0, 0, 0));
  ObjectOptions options = at(0.1, 0.2, 0);
  options.velocity = {0, -2, 0};
  const ObjectId body = world.add_rigid_body(small_box, {.density = 100}, options);
  const double before = world.rigid_body(body).mass * -2;
  run(world, 0.5);
  double after = world.rigid_body(body).mass * world.rigid_body(body).velocity.y;
  const auto v = world.velocities(cloth);
  for (const Vec3f& u : v)
    after += static_cast<double>(u.y) * world.total_mass(cloth) / static_cast<double>(v.size());
  EXPECT_GT(world.rigid_body(body).velocity.y, -1.98);
  EXPECT_NEAR(after / before, 1, 0.02);
}

TEST(RigidBodies, ASnapshotHoldsThem) {
  World world = on_the_ground();
  for (int i = 0; i < 4; ++i) world.add_rigid_body(small_box, {}, at(0.03 * i, 0.3 + 0.25 * i, 0));
  run(world, 0.7);
  const Snapshot snapshot = world.snapshot();
  run(world, 0.5);
  const std::uint64_t hash = world.hash();
  world.restore(snapshot);
  run(world, 0.5);
  EXPECT_EQ(world.hash(), hash);
}

TEST(RigidBodies, ATeleportMovesTheBody) {
  World world;
  ObjectOptions options = at(0, 1, 0);
  options.velocity = {1, 0, 0};
  const ObjectId body = world.add_rigid_body(small_box, {}, options);
  const Quatd quarter = Quatd::from_axis_angle({0, 1, 0}, 3.14159265358979 / 2);
  world.teleport(body, {{5, 0, 0}, quarter, 1});
  const RigidBodyState state = world.rigid_body(body);
  EXPECT_LT(length(state.pose.translation - Vec3d{5, 1, 0}), 1e-9);
  EXPECT_LT(length(state.velocity - Vec3d{0, 0, -1}), 1e-6);
  run(world, 0.1);
  EXPECT_NEAR(world.rigid_body(body).pose.translation.z, -0.1, 1e-3);
}

TEST(RigidBodies, AnImpulseTurnsABody) {
  World world;
  Settings settings = world.settings();
  settings.gravity = {};
  world.set_settings(settings);
  const ObjectId body = world.add_rigid_body(small_box, {}, {});
  const Vec3f corner = world.positions(body)[0];
  world.apply_impulse(body, vertices({0}), {0, 1, 0});
  run(world, 1.0 / 60);
  const RigidBodyState state = world.rigid_body(body);
  EXPECT_NEAR(state.velocity.y, 1 / state.mass, 1e-4);
  const Vec3d spin = cross(Vec3d(corner), {0, 1, 0}) / state.inertia.x;
  EXPECT_LT(length(state.angular_velocity - spin), 1e-3 * length(spin));
}

TEST(RigidBodies, WhatDoesNotApplyIsRefusedInWords) {
  World world;
  const ObjectId body = world.add_rigid_body(small_box, {}, {});
  const ObjectId cloth = world.add_cloth(grid(3, 3, 1), material::cotton);
  expect_error([&] { world.pin(body, vertices({0})); }, {"rigid body"});
  expect_error([&] { world.set_positions(body, world.positions(body)); }, {"use teleport"});
  expect_error([&] { (void)world.rigid_body(cloth); }, {"expected a rigid_body"});
  expect_error([&] { world.add_rigid_body(Plane{}); }, {"no shape of a rigid body"});
  expect_error([&] { world.add_rigid_body(grid(3, 3, 1)); }, {"rigid_body"});
  expect_error([&] { world.add_rigid_body(small_box, {.density = 0}); }, {"density"});
  RigidBodyMaterial heavier;
  heavier.density = 1e4f;
  expect_error([&] { world.set_material(body, heavier); }, {"keeps its mass"});
}

}  // namespace souple::test_world_rigid_bodies
