#include "tests/expect_error.h"
#include "tests/world/rigid_bodies.h"

#include <cmath>

#include <gtest/gtest.h>

// Energy and momentum of rigid bodies, and the impulses that change them.

namespace souple::test_world_rigid_body_energy {

const Box slab{{}, {0.1f, 0.05f, 0.2f}};

TEST(RigidBodyEnergy, IsThatOfASolid) {
  World world;
  ObjectOptions options = at(0, 2, 0);
  options.velocity = {1, 2, 0}, options.angular_velocity = {0, 0, 10};
  const ObjectId body = world.add_rigid_body(slab, {.density = 1000}, options);
  const double m = 8, I = m * (0.04 + 0.01) / 12;
  EXPECT_NEAR(world.kinetic_energy(body), 0.5 * m * 5 + 0.5 * I * 100, 1e-4);
  EXPECT_NEAR(world.potential_energy(body), m * 9.81 * 2, 1e-4);
  EXPECT_LT(length(world.momentum(body) - Vec3d{m, 2 * m, 0}), 1e-5);
  EXPECT_LT(length(world.center_of_mass(body) - Vec3d{0, 2, 0}), 1e-9);
}

TEST(RigidBodyEnergy, StaysWhereABoxSpinsAndFalls) {
  World world;
  Settings settings = world.settings();
  settings.wind.air_density = 0;
  world.set_settings(settings);
  ObjectOptions options = at(0, 50, 0);
  options.velocity = {1, 5, 0}, options.angular_velocity = {4, 9, -2};
  // A mesh whose vertices are not spread as its mass is.
  const ObjectId body = world.add_rigid_body(slab, {.density = 1000}, options);
  const auto energy = [&] { return world.kinetic_energy(body) + world.potential_energy(body); };
  const double before = energy(), spin = world.kinetic_energy(body);
  run(world, 2);
  EXPECT_GT(world.kinetic_energy(body), 2 * spin);
  // Symplectic Euler: the height at the end of a substep is g h t / 2 lower than that of the parabola.
  const double h = 1.0 / 600;
  EXPECT_NEAR(energy(), before - 8 * 9.81 * (9.81 * h * 2 / 2), 1e-3 * before);
  EXPECT_NEAR(energy(), before, 0.005 * before);
}

TEST(RigidBodyEnergy, AnImpulseAtAPointMovesAndTurns) {
  World world = without_gravity();
  const ObjectId body = world.add_rigid_body(slab, {.density = 1000}, at(1, 0, 0));
  world.apply_impulse(body, Vec3f{0, 4, 0}, Vec3f{1.1f, 0, 0.2f});
  const double m = 8;
  const Vec3d I{m * (0.01 + 0.16) / 12, m * (0.04 + 0.16) / 12, m * (0.04 + 0.01) / 12};
  const auto check = [&] {
    const RigidBodyState state = world.rigid_body(body);
    EXPECT_LT(length(state.velocity - Vec3d{0, 0.5, 0}), 1e-5);
    return state.angular_velocity;
  };
  const Vec3d L{-0.2 * 4, 0, 0.1 * 4};
  EXPECT_LT(length(check() - Vec3d{L.x / I.x, 0, L.z / I.z}), 1e-4);
  EXPECT_NEAR(world.kinetic_energy(body), 0.5 * m * 0.25 + 0.5 * (L.x * L.x / I.x + L.z * L.z / I.z), 1e-3);
  run(world, 0.2);
  check();
  const Vec3d w = world.rigid_body(body).angular_velocity;
  world.apply_angular_impulse(body, Vec3f{0, 1, 0});
  const RigidBodyState state = world.rigid_body(body);
  const Mat3d R = rotation_matrix(state.pose.rotation);
  const Vec3d local = transpose(R) * Vec3d{0, 1, 0};
  const Vec3d change =
      R * Vec3d{local.x / state.inertia.x, local.y / state.inertia.y, local.z / state.inertia.z};
  EXPECT_LT(length(state.angular_velocity - w - change), 1e-3 * length(change));
}

// The frame before the impulse and the one after it add up, whichever way the impulse came.
TEST(RigidBodyEnergy, ImpulsesOfAllKindsAddUp) {
  World world = without_gravity();
  const ObjectId body = world.add_rigid_body(small_box, {.density = 1000}, at(0, 0, 0));
  world.after(Stage::integrate, [&](World& w) {
    if (w.time() == 0) w.apply_impulse(body, Vec3f{8, 0, 0}, Vec3f{});
  });
  world.apply_impulse(body, vertices({0, 1, 2, 3, 4, 5, 6, 7}), {0, 8, 0});
  world.apply_impulse(body, Vec3f{0, 0, 8}, Vec3f{});
  EXPECT_LT(length(world.rigid_body(body).velocity - Vec3d{0, 1, 1}), 1e-4);
  world.step(1.0 / 60);
  EXPECT_LT(length(world.rigid_body(body).velocity - Vec3d{1, 1, 1}), 1e-4);
  world.set_body_velocity(body, {0, 0, 2}, {0, 3, 0});
  world.step(1.0 / 60);
  EXPECT_LT(length(world.rigid_body(body).velocity - Vec3d{0, 0, 2}), 1e-4);
  EXPECT_LT(length(world.rigid_body(body).angular_velocity - Vec3d{0, 3, 0}), 1e-4);
}

TEST(RigidBodyEnergy, WhatIsNoRigidBodyIsRefusedInWords) {
  World world;
  const ObjectId cloth = world.add_cloth(grid(3, 3, 1));
  const ObjectId body = world.add_rigid_body(small_box);
  const float none = std::nanf("");
  expect_error([&] { world.apply_impulse(cloth, Vec3f{}, Vec3f{}); }, {"expected a rigid_body"});
  expect_error([&] { world.apply_angular_impulse(cloth, {}); }, {"expected a rigid_body"});
  expect_error([&] { world.set_body_velocity(cloth, {}, {}); }, {"expected a rigid_body"});
  expect_error([&] { world.apply_impulse(body, Vec3f{none, 0, 0}, Vec3f{}); }, {"finite"});
  expect_error([&] { world.set_body_velocity(body, {1e30f, 0, 0}, {}); }, {"velocity"});
}

}  // namespace souple::test_world_rigid_body_energy
