// A signed distance field as a collider of a world.
#include "souple/souple.h"
#include "souple/world/memory.h"
#include "tests/collision/revolved.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace souple::test_world_signed_distance_collider {

void run(World& world, double seconds) {
  for (int frame = 0; frame < std::lround(seconds * 60); ++frame) world.step(1.0 / 60);
}

/// Height of the cloth's highest vertex.
double top(const World& world, ObjectId cloth) {
  float highest = -1e9f;
  for (const Vec3f& x : world.positions(cloth)) highest = std::max(highest, x.y);
  return static_cast<double>(highest);
}

/// Distance from the cloth's nearest vertex to a torus.
double nearest_to_torus(const World& world, ObjectId cloth, double major, double minor) {
  double nearest = 1e9;
  for (const Vec3f& x : world.positions(cloth)) {
    const double ring = std::hypot(double(x.x), double(x.z)) - major;
    nearest = std::min(nearest, std::hypot(ring, double(x.y)) - minor);
  }
  return nearest;
}

ObjectId drop_cloth(World& world) {
  ClothMaterial material = material::cotton;
  material.thickness = 0.02f;
  material.friction = 0.8f;
  return world.add_cloth(grid(25, 25, 0.8), material, {.transform = {.translation = {0.01, 0.2, 0.02}}});
}

TEST(SignedDistanceCollider, AClothLiesOnItAsOnItsMesh) {
  const TriangleMesh ring = torus(0.3, 0.1, 48, 24);
  const double spacing = 0.02;
  World on_field, on_mesh;
  on_field.add_collider(SignedDistanceField(ring, spacing), {.friction = 0.8f});
  on_mesh.add_obstacle(ring, {.thickness = 0.0f, .friction = 0.8f});
  const ObjectId a = drop_cloth(on_field), b = drop_cloth(on_mesh);
  run(on_field, 1.5);
  run(on_mesh, 1.5);
  EXPECT_NEAR(nearest_to_torus(on_field, a, 0.3, 0.1), 0.01, 0.002);
  EXPECT_NEAR(top(on_field, a), top(on_mesh, b), 0.5 * spacing);
  EXPECT_NEAR(on_field.center_of_mass(a).y, on_mesh.center_of_mass(b).y, spacing);
}

// The wall is two sample spacings thick; a grain is three wide.
TEST(SignedDistanceCollider, NoGrainLeavesAGlass) {
  const double radius = 0.1, wall = 0.02;
  World world;
  world.add_collider(SignedDistanceField(test::glass(radius, 0.3, wall, 48), 0.01));
  std::vector<Vec3d> centers;
  for (int i = 0; i < 200; ++i) {
    const int layer = i / 25;
    const double angle = 2.4 * i, away = 0.014 * std::sqrt(i % 25);
    centers.push_back({away * std::cos(angle), 0.03 + 0.035 * layer, away * std::sin(angle)});
  }
  const ObjectId grains = world.add_grains(centers, {.radius = 0.015f, .friction = 0.1f});
  std::vector<Vec3f> velocities(centers.size(), {3, 0, 1});
  world.set_velocities(grains, velocities);
  run(world, 2);
  for (const Vec3f& x : world.positions(grains)) {
    EXPECT_LT(std::hypot(x.x, x.z), radius - 0.012);
    EXPECT_GT(x.y, 0.012f);
    EXPECT_LT(x.y, 0.3f);
  }
}

TEST(SignedDistanceCollider, CarriesWhatLiesOnItWhenItMoves) {
  World world;
  const auto motion = ColliderMotion::callback([](double t) {
    const Vec3d axis{0, 1, 0};
    return Transform{.translation = {0.2 * t, 1, 0}, .rotation = Quatd::from_axis_angle(axis, 0.3 * t)};
  });
  world.add_collider(SignedDistanceField(box({1, 0.2, 0.6}), 0.04), {.friction = 1, .motion = motion});
  const Vec3d start[] = {{0, 1.15, 0}};
  const ObjectId grain = world.add_grains(start, {.radius = 0.05f, .friction = 1});
  run(world, 2);
  EXPECT_NEAR(world.positions(grain)[0].x, 0.4f, 0.02f);
  EXPECT_NEAR(world.positions(grain)[0].y, 1.15f, 2e-3f);
}

// Fast enough to pass the plate within a substep.
TEST(SignedDistanceCollider, NothingFastPassesIt) {
  World world;
  world.add_collider(SignedDistanceField(box({2, 0.05, 2}), 0.02));
  std::vector<Vec3d> centers;
  centers.reserve(25);
  for (int i = 0; i < 25; ++i) {
    const int row = i / 5;
    centers.push_back({0.1 * (i % 5), 0.5 + 0.05 * i, 0.1 * row});
  }
  const ObjectId grains = world.add_grains(centers, {.radius = 0.01f});
  world.set_velocities(grains, std::vector<Vec3f>(centers.size(), {5, -200, 0}));
  run(world, 0.05);
  for (const Vec3f& x : world.positions(grains)) EXPECT_GT(x.y, 0.03f);
}

TEST(SignedDistanceCollider, ItsMemoryIsReported) {
  World world;
  const SignedDistanceField field(sphere(3, 1), 0.1);
  world.add_collider(field);
  for (const MemoryReport::Part& part : world.memory().objects)
    if (part.name == "signed distance fields") {
      EXPECT_EQ(part.bytes, field.bytes());
      return;
    }
  ADD_FAILURE() << "not reported";
}

}  // namespace souple::test_world_signed_distance_collider
