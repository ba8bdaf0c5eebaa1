// Self-collision of particles: balls at vertices.
#include "souple/geometry/builders.h"
#include "souple/world/world.h"
#include "tests/expect_error.h"
#include "tests/intersections/crossings.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace souple::test_world_vertex_balls {

using test::CrossingCounter;

std::size_t crossings(const World& world) {
  CrossingCounter counter;
  for (const ObjectId id : world.objects()) counter.add(world.positions(id), world.mesh(id).triangles);
  return counter.crossings();
}

ObjectOptions with_balls(const Transform& transform = {}) {
  ObjectOptions options;
  options.self_collision = SelfCollision::particles;
  options.transform = transform;
  return options;
}

World falling_sheet(int n, SelfCollision self_collision, const Settings& settings = {}) {
  World world(settings);
  ObjectOptions options = with_balls({{0, 0.52, 0}, Quatd::from_axis_angle({0, 0, 1}, 1.48), 1});
  options.self_collision = self_collision;
  world.add_cloth(grid(n, n, 1), {.areal_density = 0.2f, .thickness = 0.3f / static_cast<float>(n)}, options);
  world.add_collider(Plane{});
  return world;
}

std::size_t self_contacts(const World& world) {
  std::size_t count = 0;
  for (const ContactEvent& contact : world.contacts()) count += contact.other_is_collider ? 0 : 1;
  return count;
}

// Also irregular edges, and a tube that is closed at rest.
TEST(VertexBalls, TheShapeAtRestHasNoContact) {
  TriangleMesh uneven = grid(20, 20, 1);
  for (Vec3d& x : uneven.positions) x.x += 0.4 * x.x * x.x;
  for (const TriangleMesh& mesh : {grid(20, 20, 1), uneven, torus(0.3, 0.05, 40, 12), sphere(2, 0.2)}) {
    std::vector<std::uint64_t> hashes;
    for (const SelfCollision mode : {SelfCollision::particles, SelfCollision::off}) {
      World world({.gravity = {}});
      ObjectOptions options;
      options.self_collision = mode;
      world.add_cloth(mesh, {}, options);
      for (int frame = 0; frame < 3; ++frame) world.step(1.0 / 60);
      EXPECT_EQ(world.report().contacts, 0u);
      hashes.push_back(world.hash());
    }
    EXPECT_EQ(hashes[0], hashes[1]);
  }
}

// Two halves of a sheet, folded over each other and closing at 2 m/s, stop each other.
TEST(VertexBalls, LayersOfAFoldedSheetStayApart) {
  World world({.gravity = {}});
  const TriangleMesh mesh = grid(30, 30, 1);
  const ObjectId cloth = world.add_cloth(mesh, {.thickness = 0.005f}, with_balls());
  std::vector<Vec3f> x, v;
  for (const Vec3d& at : mesh.positions) {
    constexpr double radius = 0.05;  // m, of the fold
    const double turned = std::clamp(at.x / radius, 0.0, pi), beyond = std::max(0.0, at.x - pi * radius);
    x.push_back(Vec3f{float(std::min(at.x, 0.0) + radius * std::sin(turned) - beyond),
                      float(radius * (1 - std::cos(turned))), float(at.z)});
    v.push_back({0, at.x > pi * radius ? -1.0f : at.x < 0 ? 1.0f : 0.0f, 0});
  }
  world.set_positions(cloth, x);
  world.set_velocities(cloth, v);
  std::size_t most = 0;
  for (int frame = 0; frame < 60; ++frame) {
    world.step(1.0 / 60);
    most = std::max(most, self_contacts(world));
    EXPECT_EQ(crossings(world), 0u) << frame;
  }
  EXPECT_GT(most, 50u);
}

// Measured: no crossing at any size from 80 to 125 vertices a side, 10 edges of 67,000 at 150.
TEST(VertexBalls, AHeapHasFewCrossings) {
  World world = falling_sheet(40, SelfCollision::particles);
  World without = falling_sheet(40, SelfCollision::off);
  const ObjectId cloth = world.objects()[0];
  for (int frame = 0; frame < 75; ++frame) {
    world.step(1.0 / 60);
    without.step(1.0 / 60);
  }
  const std::size_t found = world.count_crossings(cloth);
  EXPECT_LE(found, 20u) << "of 4,600 edges";
  EXPECT_GT(without.count_crossings(cloth), 500u);
  EXPECT_EQ(world.report().intersections, 0u) << "none is searched or resolved";
  EXPECT_FALSE(world.report().has(Flag::intersecting));
}

// While it falls: in a flat heap many edges only touch triangles, which may count or not.
TEST(VertexBalls, CrossingsAreCountedAsTheCheckerCountsThem) {
  World world = falling_sheet(20, SelfCollision::off);
  for (int frame = 0; frame < 30; ++frame) world.step(1.0 / 60);
  const ObjectId cloth = world.objects()[0];
  CrossingCounter checker;
  checker.add(world.positions(cloth), world.mesh(cloth).triangles);
  std::size_t edges = 0;
  for (const Edge& edge : unique_edges(checker.triangles))
    if (std::any_of(checker.triangles.begin(), checker.triangles.end(),
                    [&](const Triangle& t) { return checker.passes(edge, t); }))
      ++edges;
  EXPECT_GT(edges, 100u);
  EXPECT_NEAR(static_cast<double>(world.count_crossings(cloth)), static_cast<double>(edges),
              0.06 * static_cast<double>(edges));
}

// A crumpled sheet in free flight: the contacts and the bound on motion leave its momentum as it is.
TEST(VertexBalls, MomentumIsConserved) {
  World world({.gravity = {}});
  const TriangleMesh mesh = grid(24, 24, 1);
  ObjectOptions options = with_balls();
  const ObjectId cloth = world.add_cloth(mesh, {.thickness = 0.005f}, options);
  std::vector<Vec3f> v;
  for (const Vec3d& x : mesh.positions)
    v.push_back(
        {float(3 - 48 * x.x + 60 * x.x * x.x), float(80 * x.x * x.z), float(-48 * x.z)});  // closes in
  world.set_velocities(cloth, v);
  const Vec3d before = world.momentum(cloth);
  std::size_t most = 0;
  for (int frame = 0; frame < 40; ++frame) {
    world.step(1.0 / 60);
    most = std::max(most, self_contacts(world));
  }
  EXPECT_GT(most, 20u);
  EXPECT_LT(length(world.momentum(cloth) - before), 2e-5 * length(before));
}

TEST(VertexBalls, ARestoredSnapshotGoesOnToTheBit) {
  World world = falling_sheet(24, SelfCollision::particles);
  for (int frame = 0; frame < 40; ++frame) world.step(1.0 / 60);
  const Snapshot snapshot = world.snapshot();
  for (int frame = 0; frame < 10; ++frame) world.step(1.0 / 60);
  const std::uint64_t hash = world.hash();
  World other = falling_sheet(24, SelfCollision::particles);
  other.restore(snapshot);
  for (int frame = 0; frame < 10; ++frame) other.step(1.0 / 60);
  EXPECT_EQ(other.hash(), hash);
}

TEST(VertexBalls, FrictionHoldsLayersOnEachOther) {
  const auto slid = [](float friction) {
    World world({.gravity = {0, -9.81f, 0}});
    const TriangleMesh mesh = grid(24, 12, 1);
    ClothMaterial material{.thickness = 0.005f};
    material.friction = friction;
    const ObjectId cloth = world.add_cloth(mesh, material, with_balls());
    world.add_collider(Plane{.offset = -0.01f}, {.friction = 1});
    std::vector<Vec3f> x, v(mesh.positions.size());
    std::size_t corner = 0;
    for (std::size_t k = 0; k < mesh.positions.size(); ++k) {
      const Vec3d& at = mesh.positions[k];
      constexpr double radius = 0.035;
      const double turned = std::clamp(at.x / radius, 0.0, pi), beyond = std::max(0.0, at.x - pi * radius);
      x.push_back(Vec3f{float(std::min(at.x, 0.0) + radius * std::sin(turned) - beyond),
                        float(radius * (1 - std::cos(turned))), float(at.z)});
      if (at.x > 0.1) v[k] = {0, 0, 0.6f};
      if (at.x > mesh.positions[corner].x) corner = k;
    }
    world.set_positions(cloth, x);
    world.set_velocities(cloth, v);
    const float z = x[corner].z;
    for (int frame = 0; frame < 20; ++frame) world.step(1.0 / 60);
    return world.positions(cloth)[corner].z - z;
  };
  EXPECT_LT(slid(0.8f), 0.6f * slid(0));
}

TEST(VertexBalls, APairOfTheNameWithItselfSwitchesThemOff) {
  World world = falling_sheet(16, SelfCollision::particles), off = falling_sheet(16, SelfCollision::off);
  world.set_collide("cloth", "cloth", false);
  for (int frame = 0; frame < 40; ++frame) world.step(1.0 / 60), off.step(1.0 / 60);
  EXPECT_EQ(world.hash(), off.hash());
  EXPECT_EQ(world.self_collision(world.objects()[0]), SelfCollision::particles);
}

TEST(VertexBalls, OnlyObjectsWithTrianglesHaveThem) {
  World world;
  const std::vector<Vec3d> line{{0, 0, 0}, {1, 0, 0}};
  expect_error([&] { world.add_rope(line, 10, {}, with_balls()); }, {"self_collision", "particles"});
  expect_error(
      [&] {
        world.add_soft_body(box({0.1, 0.1, 0.1}), {}, {.cells = 60}, with_balls());
      },
      {"self_collision", "tets"});
  world.add_soft_body(tet_bar(3, 3, 3, {0.1, 0.1, 0.1}), {}, with_balls());
  EXPECT_TRUE(world.step(1.0 / 60).ok());
}

// Crushed to a point, so that each ball is near all others: a step ends, and nothing is infinite.
TEST(VertexBalls, ACrushedSheetStopsNothing) {
  World world;
  const TriangleMesh mesh = grid(60, 60, 1);
  const ObjectId cloth = world.add_cloth(mesh, {}, with_balls());
  std::vector<Vec3f> x;
  for (const Vec3d& at : mesh.positions) x.push_back(Vec3f(at * 0.01));
  world.set_positions(cloth, x);
  for (int frame = 0; frame < 3; ++frame) EXPECT_TRUE(world.step(1.0 / 60).ok());
}

}  // namespace souple::test_world_vertex_balls
