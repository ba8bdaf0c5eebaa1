#include "tests/expect_error.h"
#include "tests/world/scene.h"

#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace souple::test_world_rigid_bodies {

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
  World world({.sleeping = {.enabled = true}});
  world.add_collider(Plane{});
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
  World world({.sleeping = {.enabled = true}});
  world.add_collider(Plane{});
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

struct Impact {
  enum class Kind { cloth, rope, tets, grains, lattice };
  Kind kind = Kind::cloth;
  bool box = true;
  float speed = 2;
  int substeps = 10;
  float young_modulus = 1e4f, density = 1000;  // of tets
};

ObjectId add_target(World& world, const Impact& impact) {
  switch (impact.kind) {
    case Impact::Kind::cloth:
      return world.add_cloth(grid(15, 15, 1), material::cotton);
    case Impact::Kind::rope: {
      const Vec3d ends[] = {{-0.5, 0, 0}, {0.5, 0, 0}};
      return world.add_rope(ends, 30);
    }
    case Impact::Kind::tets:
      return world.add_soft_body(tet_bar(8, 3, 3, {0.8, 0.3, 0.3}),
                                 {.young_modulus = impact.young_modulus, .density = impact.density});
    case Impact::Kind::lattice:
      return world.add_soft_body(sphere(3, 0.2), {.young_modulus = 1e5f, .density = 200}, LatticeOptions{});
    case Impact::Kind::grains:
      break;
  }
  std::vector<Vec3d> centers;
  for (int i = -5; i <= 5; ++i)
    for (int j = -2; j <= 0; ++j)
      for (int k = -5; k <= 5; ++k) centers.push_back({0.0401 * i, 0.0401 * j, 0.0401 * k});
  return world.add_grains(centers, {.radius = 0.02f});
}

double height_of(Impact::Kind kind) {
  switch (kind) {
    case Impact::Kind::cloth:
      return 0.001;
    case Impact::Kind::rope:
      return 0.005;
    case Impact::Kind::tets:
      return 0.15;
    case Impact::Kind::lattice:
      return 0.2;
    case Impact::Kind::grains:
      return 0.02;
  }
  return 0;
}

Vec3d angular_momentum(const RigidBodyState& body) {
  const Vec3d spin = rotate(conjugate(body.pose.rotation), body.angular_velocity);
  const Vec3d& inertia = body.inertia;
  return cross(body.pose.translation, body.velocity) * body.mass +
         rotate(body.pose.rotation, {inertia.x * spin.x, inertia.y * spin.y, inertia.z * spin.z});
}

/// Steps, and returns the angular momentum about the origin at its start. A field without force sees all particles.
Vec3d step_from(World& world, ObjectId target, ObjectId body) {
  Vec3d sum = angular_momentum(world.rigid_body(body));
  const double start = world.time();
  const ForceFieldId field = world.add_force_field([&](const ForcePoint& point) {
    if (point.object == target && point.time == start)
      sum += cross(Vec3d(point.position), Vec3d(point.velocity)) * static_cast<double>(point.mass);
    return Vec3f{};
  });
  const auto spins = world.angular_velocities(target);  // of grains, else none
  const double inertia =
      spins.empty() ? 0 : 0.4 * world.total_mass(target) / double(spins.size()) * 0.02 * 0.02;
  for (const Vec3f& spin : spins) sum += Vec3d(spin) * inertia;
  world.step(1.0 / 60);
  world.remove(field);
  return sum;
}

// Also where it moves by much more than the thickness in a substep, and where it hits beside the center.
TEST(RigidImpacts, KeepMomentumAndAddNoEnergy) {
  using enum Impact::Kind;
  const Impact impacts[] = {{cloth},
                            {cloth, false, 10, 5},
                            {rope, false, 2},
                            {rope, true, 10, 5},
                            {tets, true, 2},
                            {tets, false, 2, 10, 1e4f, 50},
                            {tets, false, 0.5f, 5, 1e7f},
                            {tets, true, 2, 10, 1e7f},
                            {tets, true, 2, 5, 1e4f},
                            {tets, true, 10, 5, 1e7f},
                            {tets, false, 10, 5, 1e4f, 50},
                            {grains, false, 10, 5},
                            {grains, true, 2},
                            {lattice, true, 2},
                            {lattice, false, 0.5f, 5},
                            {lattice, false, 10}};
  for (const Impact& impact : impacts) {
    World world({.substeps = impact.substeps, .gravity = {}, .wind = {.air_density = 0}, .threads = 1});
    const ObjectId target = add_target(world, impact);
    ObjectOptions options = at(0.05, height_of(impact.kind) + (impact.box ? 0.18 : 0.12), 0.03);
    options.velocity = {0, -impact.speed, 0};
    options.transform.rotation = Quatd::from_axis_angle({0.3, 0.5, 0.8}, 0.4);
    const ObjectId body = impact.box ? world.add_rigid_body(small_box, {.density = 200}, options)
                                     : world.add_rigid_body(Sphere{{}, 0.1f}, {.density = 300}, options);
    const Vec3d before = total_momentum(world);
    const double energy = world.kinetic_energy(body);
    const Vec3d angular_before = angular_momentum(world.rigid_body(body));
    const std::string where = std::to_string(static_cast<int>(impact.kind)) + ", " +
                              std::to_string(impact.speed) + " m/s, " + std::to_string(impact.substeps);
    for (int frame = 0; frame < 18 / static_cast<double>(impact.speed) + 6; ++frame) {
      const Vec3d angular = step_from(world, target, body);
      EXPECT_LT(length(angular - angular_before), 0.01 * length(angular_before)) << where;
      EXPECT_LT(length(total_momentum(world) - before), 1e-3 * length(before)) << where;
      EXPECT_LT(world.kinetic_energy(body) + world.kinetic_energy(target), 1.001 * energy) << where;
    }
    EXPECT_GT(world.rigid_body(body).velocity.y, -0.99 * static_cast<double>(impact.speed)) << where;
  }
}

// The cloth cannot give way between a body and the face of another, flat or tilted.
TEST(RigidImpacts, KeepMomentumThroughACloth) {
  for (const float speed : {0.5f, 2.0f, 5.0f})
    for (const int substeps : {5, 10, 40})
      for (const bool tilted : {false, true}) {
        World world({.substeps = substeps, .gravity = {}, .wind = {.air_density = 0}, .threads = 1});
        world.add_cloth(grid(15, 15, 1), material::cotton);
        world.add_rigid_body(small_box, {.density = 400}, at(0, -0.105, 0));
        ObjectOptions options = tilted ? at(0.07, 0.2, 0.01) : at(0.02, 0.14, 0.01);
        if (tilted) options.transform.rotation = Quatd::from_axis_angle({0.3, 0.5, 0.8}, 0.4);
        options.velocity = {0, -speed, 0};
        const ObjectId body = world.add_rigid_body(small_box, {.density = 200}, options);
        const Vec3d before = total_momentum(world);
        const double energy = world.kinetic_energy(body);
        for (int frame = 0; frame < 20; ++frame) {
          world.step(1.0 / 60);
          double now = 0;
          for (const ObjectId id : world.objects()) now += world.kinetic_energy(id);
          EXPECT_LT(length(total_momentum(world) - before), 1e-3 * length(before))
              << speed << " m/s, " << substeps << " substeps, tilted " << tilted << ", frame " << frame;
          EXPECT_LT(now, 1.001 * energy) << speed;
        }
      }
}

// A brick that moves by a thousand times its size in a substep.
TEST(RigidImpacts, AddNoEnergyHoweverFast) {
  for (const float speed : {1e4f, 1e5f, 1e6f}) {
    World world({.gravity = {}, .threads = 1});
    for (int row = 0; row < 5; ++row)
      for (int k = 0; k < 5; ++k)
        world.add_rigid_body(Box{{}, {0.2f, 0.1f, 0.1f}}, {.density = 1800, .friction = 0.7f},
                             at(0.404 * k + 0.2 * (row % 2), 0.2 * row, 0));
    ObjectOptions options = at(0.1, 0.3, 1);
    options.velocity = {0.05f * speed, 0.02f * speed, -speed};
    const ObjectId brick = world.add_rigid_body(Box{{}, {0.2f, 0.1f, 0.1f}}, {.density = 1800}, options);
    const double energy = world.kinetic_energy(brick);
    const Vec3d before = total_momentum(world);
    for (int frame = 0; frame < 5; ++frame) {
      EXPECT_TRUE(world.step(1.0 / 60).ok()) << speed;
      double now = 0;
      for (const ObjectId id : world.objects()) now += world.kinetic_energy(id);
      EXPECT_LT(now, 1.001 * energy) << speed << ", frame " << frame;
      EXPECT_LT(length(total_momentum(world) - before), 1e-3 * length(before)) << speed;
    }
  }
}

TEST(RigidBodies, ASnapshotHoldsThem) {
  const auto build = [] {
    World world = on_the_ground();
    for (int i = 0; i < 4; ++i) world.add_rigid_body(small_box, {}, at(0.03 * i, 0.3 + 0.25 * i, 0));
    return world;
  };
  expect_resumes(build, 0.7, 0.5);
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
  World world({.gravity = {}});
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

// Contacts of rigid bodies with each other and with colliders, as World::contacts and World::contact_pairs tell them.

constexpr double g = 9.81;  // m/s^2

TEST(RigidBodyContacts, CarryTheWeightOfABox) {
  World world;
  const ColliderId floor = world.add_collider(Plane{}, {.name = "floor"});
  const ObjectId box = world.add_rigid_body(small_box, {.density = 700}, at(0.3, 0.1, 0));
  run(world, 1);
  const double h = 1.0 / 60 / world.settings().substeps;
  ASSERT_EQ(world.contacts().size(), 4u);
  EXPECT_EQ(world.report().contacts, 4u);
  double force = 0;
  Vec3d torque;
  for (const ContactEvent& event : world.contacts()) {
    EXPECT_EQ(event.object_id, box);
    EXPECT_TRUE(event.other_is_collider);
    EXPECT_EQ(event.collider_id, floor);
    EXPECT_EQ(event.other, "floor");
    EXPECT_NEAR(event.normal.y, 1, 1e-6);
    EXPECT_NEAR(event.point.y, 0, 1e-3);
    EXPECT_LT(length(world.positions(box)[event.vertex] - event.point), 1e-3);
    force += static_cast<double>(event.impulse) / h;
    torque += cross(Vec3d(event.point) - Vec3d{0.3, 0, 0}, Vec3d(event.normal * event.impulse)) / h;
  }
  const double weight = world.rigid_body(box).mass * g;
  EXPECT_NEAR(force, weight, 0.01 * weight);
  EXPECT_LT(length(torque), 0.01 * weight * 0.1);
}

TEST(RigidBodyContacts, ABodyCarriesTheNext) {
  World world = on_the_ground();
  const ObjectId below = world.add_rigid_body(small_box, {}, at(0, 0.1, 0));
  const ObjectId above = world.add_rigid_body(Sphere{{}, 0.1f}, {}, at(0, 0.3, 0));
  run(world, 1);
  const double h = 1.0 / 60 / world.settings().substeps;
  double between = 0, floor = 0;
  for (const ContactEvent& event : world.contacts()) {
    if (event.other_is_collider) {
      floor += static_cast<double>(event.impulse) / h;
      continue;
    }
    EXPECT_EQ(event.object_id, below);
    EXPECT_EQ(event.other_id, above);
    EXPECT_NEAR(event.normal.y, -1, 1e-3);
    EXPECT_NEAR(event.point.y, 0.2, 1e-3);
    between += static_cast<double>(event.impulse) / h;
  }
  const double weight = world.rigid_body(above).mass * g;
  EXPECT_NEAR(between, weight, 0.01 * weight);
  const double both = weight + world.rigid_body(below).mass * g;
  EXPECT_NEAR(floor, both, 0.01 * both);
}

TEST(RigidBodyContacts, PairsBeginAndEnd) {
  World world;
  const ColliderId floor = world.add_collider(Plane{});
  const ObjectId box = world.add_rigid_body(small_box, {}, at(0, 0.12, 0));
  world.track_contacts(true);
  std::vector<ContactPhase> phases;
  double impulse = 0;
  for (int frame = 0; frame < 60; ++frame) {
    if (frame == 30) world.set_body_velocity(box, {0, 3, 0}, {});
    world.step(1.0 / 60);
    for (const ContactPair& pair : world.contact_pairs()) {
      EXPECT_EQ(pair.object, box);
      EXPECT_TRUE(pair.is_collider);
      EXPECT_EQ(pair.collider, floor);
      phases.push_back(pair.phase);
      if (frame == 29) impulse = static_cast<double>(pair.impulse);
    }
  }
  ASSERT_GE(phases.size(), 3u);
  EXPECT_EQ(phases.front(), ContactPhase::begin);
  EXPECT_EQ(phases.back(), ContactPhase::end);
  for (std::size_t k = 1; k + 1 < phases.size(); ++k) EXPECT_EQ(phases[k], ContactPhase::persist) << k;
  const double weight = world.rigid_body(box).mass * g;
  EXPECT_NEAR(impulse, weight / 60, 0.01 * weight / 60);
}

TEST(RigidBodyContacts, AreDrawn) {
  World world = on_the_ground();
  world.add_rigid_body(small_box, {}, at(0, 0.1, 0));
  run(world, 0.2);
  std::size_t drawn = 0;
  DebugDraw draw;
  draw.contact = [&](const DebugContact& contact) { drawn += contact.impulse > 0 ? 1 : 0; };
  world.debug_draw(draw);
  EXPECT_EQ(drawn, 4u);
}

// Energy and momentum of rigid bodies, and the impulses that change them.

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
  World world({.wind = {.air_density = 0}});
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
  World world({.gravity = {}});
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
  World world({.gravity = {}});
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

// Mass, center and inertia that are given, and bodies of several shapes.

TEST(RigidBodyMass, MayBeGiven) {
  World world;
  ObjectOptions options = at(1, 2, 3);
  options.given_mass.mass = 12;
  const RigidBodyState state = world.rigid_body(world.add_rigid_body(small_box, {}, options));
  EXPECT_NEAR(state.mass, 12, 1e-9);
  EXPECT_NEAR(state.inertia.y, 12 * 0.08 / 12, 1e-7);
  options.given_mass.center = Vec3d{0, -0.05, 0};
  options.given_mass.inertia = Mat3d::diagonal({0.1, 0.2, 0.15});
  options.transform.rotation = Quatd::from_axis_angle({1, 0, 0}, 3.14159265358979 / 2);
  const RigidBodyState low = world.rigid_body(world.add_rigid_body(box({0.2, 0.2, 0.2}, 2), {}, options));
  EXPECT_NEAR(low.mass, 12, 1e-9);
  EXPECT_LT(length(low.pose.translation - Vec3d{1, 2, 2.95}), 1e-9);
  const Mat3d R = rotation_matrix(low.pose.rotation);
  const Mat3d I = R * Mat3d::diagonal(low.inertia) * transpose(R);
  EXPECT_NEAR(I.column[0].x, 0.1, 1e-9);
  EXPECT_NEAR(I.column[1].y, 0.15, 1e-9);
  EXPECT_NEAR(I.column[2].z, 0.2, 1e-9);
}

// A box whose center of mass is low rights itself as a tumbler does not: it stays upright further.
TEST(RigidBodyMass, ALowCenterKeepsABoxUpright) {
  World world = on_the_ground();
  const auto tilted = [&](double z, double center) {
    ObjectOptions options = at(0, 0.55, z);
    options.transform.rotation = Quatd::from_axis_angle({0, 0, 1}, 0.5);
    options.given_mass.center = Vec3d{0, center, 0};
    return world.add_rigid_body(Box{{}, {0.2f, 0.5f, 0.2f}}, {}, options);
  };
  const ObjectId low = tilted(0, -0.4), middle = tilted(2, 0);
  run(world, 3);
  EXPECT_GT(world.rigid_body(low).pose.direction({0, 1, 0}).y, 0.99);
  EXPECT_LT(std::abs(world.rigid_body(middle).pose.direction({0, 1, 0}).y), 0.1);
}

TEST(RigidBodyMass, ThatCannotBeIsRefusedInWords) {
  World world;
  ObjectOptions options = at(0, 0, 0);
  options.given_mass.mass = -1;
  expect_error([&] { world.add_rigid_body(small_box, {}, options); }, {"rigid_body", "mass", "-1"});
  options.given_mass = {.inertia = Mat3d::diagonal({1, 1, 5})};
  expect_error([&] { world.add_rigid_body(small_box, {}, options); }, {"rigid_body", "inertia"});
  expect_error([&] { world.add_cloth(grid(3, 3, 1), material::cotton, options); }, {"given_mass", "cloth"});
}

std::vector<RigidPart> dumbbell() {
  return {{Box{{}, {0.3f, 0.02f, 0.02f}}, {}, {}},
          {Sphere{{}, 0.1f}, {{-0.3, 0, 0}, {}, 1}, 2000},
          {Sphere{{}, 0.1f}, {{0.3, 0, 0}, {}, 1}, 2000}};
}

TEST(RigidBodyParts, AddUpTheirMassAndInertia) {
  World world;
  const ObjectId body = world.add_rigid_body(dumbbell(), {.density = 1000}, at(0, 1, 0));
  const RigidBodyState state = world.rigid_body(body);
  const double rod = 1000 * 0.6 * 0.04 * 0.04, ball = 2000 * 4.0 / 3 * 3.14159265358979 * 1e-3;
  const double along = rod * (0.0032) / 12 + 2 * 0.4 * ball * 0.01;
  const double across = rod * (0.36 + 0.0016) / 12 + 2 * ball * (0.4 * 0.01 + 0.09);
  EXPECT_NEAR(state.mass, rod + 2 * ball, 1e-4);
  EXPECT_LT(length(state.pose.translation - Vec3d{0, 1, 0}), 1e-7);
  EXPECT_NEAR(state.inertia.x, along, 1e-4 * along);
  EXPECT_NEAR(state.inertia.y, across, 1e-4 * across);
  EXPECT_NEAR(state.inertia.z, across, 1e-4 * across);
}

TEST(RigidBodyParts, CollideEach) {
  World world = on_the_ground();
  ObjectOptions options = at(0, 0.3, 0);
  options.transform.rotation = Quatd::from_axis_angle({0, 1, 0}, 0.3);
  const ObjectId body = world.add_rigid_body(dumbbell(), {.density = 1000}, options);
  const ObjectId between = world.add_rigid_body(Sphere{{}, 0.05f}, {}, at(0, 0.6, 0));
  run(world, 2);
  // It lies on its two balls, and what falls onto the rod rolls off or lies on it.
  EXPECT_NEAR(world.rigid_body(body).pose.translation.y, 0.1, 2e-3);
  EXPECT_GT(world.rigid_body(between).pose.translation.y, 0.049);
  EXPECT_EQ(world.report().intersections, 0u);
}

TEST(RigidBodyParts, ScaleWithTheBody) {
  World world;
  ObjectOptions options = at(0, 1, 0);
  options.transform.scale = 2;
  const ObjectId large = world.add_rigid_body(dumbbell(), {}, options);
  const ObjectId small = world.add_rigid_body(dumbbell(), {}, at(0, 5, 0));
  EXPECT_NEAR(world.rigid_body(large).mass / world.rigid_body(small).mass, 8, 1e-5);
  EXPECT_NEAR(world.rigid_body(large).inertia.y / world.rigid_body(small).inertia.y, 32, 1e-4);
}

TEST(RigidBodyParts, ThatCannotBeAreRefusedInWords) {
  World world;
  expect_error([&] { world.add_rigid_body(std::vector<RigidPart>{}); }, {"no shapes"});
  const std::vector<RigidPart> plane{{Plane{}, {}, {}}}, scaled{{Sphere{}, {{}, {}, 2}, {}}};
  expect_error([&] { world.add_rigid_body(plane); }, {"shape 0", "plane"});
  expect_error([&] { world.add_rigid_body(scaled); }, {"shape 0", "scale"});
}

// Rigid bodies that prescribed motion moves.

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
  World world({.gravity = {}});
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
  World world({.sleeping = {.enabled = true}});
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
  const auto build = [] {
    World world = on_the_ground();
    const ObjectId body = world.add_rigid_body(small_box, {}, at(0, 0.1, 0));
    world.add_rigid_body(small_box, {}, at(0.25, 0.1, 0));
    const std::vector<PoseKey> keys{{0, {}, {}}, {1, {1, 0, 0}, {}}, {2, {0, 0, 0}, {}}};
    world.set_motion(body, {.pose = ColliderMotion::keyframes(keys, true)});
    return world;
  };
  expect_resumes(build, 0.7, 2);
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

}  // namespace souple::test_world_rigid_bodies
