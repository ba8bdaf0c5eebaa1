#include "souple/souple.h"
#include "tests/expect_error.h"

#include <algorithm>

#include <gtest/gtest.h>

namespace souple::test_world_queries {

TEST(Queries, ARayHitsTheNearestObject) {
  World world;
  const ObjectId sheet = world.add_cloth(grid(11, 11, 2), {}, {.transform = {.translation = {0, 1, 0}}});
  const ColliderId floor = world.add_collider(Plane{});
  const Vec3d grain[] = {{5, 0.5, 0}};
  const ObjectId grains = world.add_grains(grain, {.radius = 0.1f});

  Hit hit = world.ray_cast({0.21f, 3, 0.39f}, {0, -1, 0});
  ASSERT_TRUE(hit.found);
  EXPECT_FALSE(hit.is_collider);
  EXPECT_EQ(hit.object, sheet);
  EXPECT_NEAR(hit.distance, 2, 1e-6);
  EXPECT_EQ(hit.vertex, 7u * 11 + 6);  // the corner at (0.2, 0.4)

  hit = world.ray_cast({3, 3, 0}, {0, -2, 0});
  ASSERT_TRUE(hit.is_collider);
  EXPECT_EQ(hit.collider, floor);
  EXPECT_NEAR(hit.distance, 3, 1e-6);

  hit = world.ray_cast({5, 3, 0}, {0, -1, 0});
  EXPECT_EQ(hit.object, grains);
  EXPECT_NEAR(hit.distance, 2.4, 1e-6);

  EXPECT_FALSE(world.ray_cast({0, 3, 0}, {0, 1, 0}).found);
  EXPECT_FALSE(world.ray_cast({0, 3, 0}, {0, -1, 0}, 1.5).found);
  expect_error([&] { world.ray_cast({0, 0, 0}, {0, 0, 0}); }, {"direction"});
}

TEST(Queries, TheClosestPoint) {
  World world;
  const ObjectId sheet = world.add_cloth(grid(3, 3, 2), {}, {.transform = {.translation = {0, 1, 0}}});
  Hit hit = world.closest_point({0.3f, 1.5f, 0.2f});
  EXPECT_EQ(hit.object, sheet);
  EXPECT_NEAR(hit.distance, 0.5, 1e-6);
  EXPECT_LT(length(hit.point - Vec3f{0.3f, 1, 0.2f}), 1e-6f);
  hit = world.closest_point({2, 1, 2});
  EXPECT_LT(length(hit.point - Vec3f{1, 1, 1}), 1e-6f);
  EXPECT_EQ(hit.vertex, 8u);
}

TEST(Queries, ContactsAreEvents) {
  World world;
  const Vec3d grain[] = {{0, 0.2, 0}};
  const ObjectId grains = world.add_grains(grain, {.radius = 0.1f, .density = 1000});
  world.add_collider(Plane{}, {.name = "floor"});
  for (int i = 0; i < 120; ++i) world.step(1.0 / 60);
  // At rest a contact is active in most substeps; find such a step.
  for (int i = 0; i < 10 && world.contacts().empty(); ++i) world.step(1.0 / 60);
  ASSERT_EQ(world.contacts().size(), 1u);
  const ContactEvent& event = world.contacts()[0];
  EXPECT_EQ(event.object, "grains");
  EXPECT_EQ(event.other, "floor");
  EXPECT_TRUE(event.other_is_collider);
  EXPECT_LT(length(event.normal - Vec3f{0, 1, 0}), 1e-5f);
  EXPECT_NEAR(event.point.y, 0, 1e-4);
  EXPECT_GT(event.impulse, 0);
  EXPECT_NEAR(world.positions(grains)[0].y, 0.1, 1e-4);
}

// Also before the first step: a rope of one segment, stiffness E pi r^2 / l, at 1.1 times its length.
TEST(Queries, ElasticEnergyNeedsNoStep) {
  World world;
  const Vec3d ends[] = {{0, 0, 0}, {2, 0, 0}};
  const ObjectId rope = world.add_rope(ends, 1, {.radius = 0.1f, .young_modulus = 1e6f});
  const Vec3f pulled[] = {{0, 0, 0}, {2.2f, 0, 0}};
  world.set_positions(rope, pulled);
  const double k = 1e6 * pi * 0.01 / 2;
  EXPECT_NEAR(world.elastic_energy(), k * 0.04 / 2, 1e-4 * k);
}

// A cloth far stiffer than one sweep can make it swings down from the horizontal. Its springs seem to store many times
// the energy that it had, but no step can return that.
TEST(Queries, EnergyOfAnUnconvergedClothDoesNotGrow) {
  Settings settings;
  settings.solver.kind = SolverKind::gauss_seidel;
  World world(settings);
  const ObjectId cloth = world.add_cloth(grid(30, 30, 1), {.membrane_stiffness = 1e6f});
  std::vector<std::uint32_t> row(30);
  for (std::uint32_t i = 0; i < 30; ++i) row[i] = i;
  world.pin(cloth, vertices(row));
  const double scale = world.total_mass(cloth) * 9.81;  // the energy of a fall by 1 m; 0 at the start
  double apparent = 0, highest = -1;
  for (int frame = 0; frame < 180; ++frame) {
    world.step(1.0 / 60);
    const double motion = world.kinetic_energy(cloth) + world.potential_energy(cloth);
    const double elastic = world.elastic_energy(), lost = world.unconverged_energy(1.0 / 60);
    EXPECT_GE(lost, 0);
    EXPECT_LE(lost, elastic);
    apparent = std::max(apparent, (motion + elastic) / scale);
    highest = std::max(highest, (motion + elastic - lost) / scale);
  }
  EXPECT_GT(apparent, 100);
  EXPECT_LT(highest, 0.02);
}

// Energy that sweeps can carry, and energy of exactly solved constraints, is complete.
TEST(Queries, EnergyOfConvergedConstraintsIsComplete) {
  World world({.substeps = 30});
  const ObjectId cloth = world.add_cloth(grid(10, 10, 1), {.membrane_stiffness = 10});
  world.pin(cloth, vertices({0, 9}));
  const Vec3d ends[] = {{2, 0, 0}, {3, 0, 0}};
  const ObjectId rope = world.add_rope(ends, 10, {.radius = 0.005f, .young_modulus = 1e9f});
  world.pin(rope, vertices({0}));
  for (int frame = 0; frame < 30; ++frame) world.step(1.0 / 60);
  EXPECT_GT(world.elastic_energy(), 0.01);
  EXPECT_LT(world.unconverged_energy(1.0 / 60), 0.01 * world.elastic_energy());
  world.remove(cloth);
  EXPECT_GT(world.elastic_energy(), 0);
  EXPECT_EQ(world.unconverged_energy(1.0 / 60), 0);
}

}  // namespace souple::test_world_queries
