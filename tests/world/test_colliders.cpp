#include "tests/collision/revolved.h"
#include "tests/world/scene.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

namespace souple::test_world_colliders {

// Contacts of triangles and edges with colliders: coarse meshes do not sink in between their vertices.

/// The smallest distance from points inside an object's triangles to a static shape.
double lowest_in_triangles(const World& world, ObjectId object, const Shape& shape) {
  constexpr int n = 12;
  double lowest = 1e9;
  const auto x = world.positions(object);
  for (const Triangle& t : world.triangles(object))
    for (int i = 0; i <= n; ++i)
      for (int j = 0; i + j <= n; ++j) {
        const double a = double(i) / n, b = double(j) / n;
        const Vec3d p = Vec3d(x[t[0]]) * a + Vec3d(x[t[1]]) * b + Vec3d(x[t[2]]) * (1 - a - b);
        lowest = std::min(lowest, surface_distance(shape, p).distance);
      }
  return lowest;
}

// Edges of 0.2 m: four times the diameter of the ball.
TEST(ColliderElementContacts, ACoarseClothStaysOutsideASmallBall) {
  const Shape shapes[] = {Sphere{{0.03f, 0, 0.02f}, 0.05f}, SignedDistanceField(sphere(3, 0.05), 0.01)};
  for (const Shape& shape : shapes) {
    World world;
    world.add_collider(shape, {.friction = 1});
    const ObjectId cloth = world.add_cloth(grid(5, 5, 0.8), thick_cloth(), at(0, 0.15, 0));
    double lowest = 1;
    int touching = 0;  // of the last 20 frames: it still swings, and its weight varies
    for (int frame = 0; frame < 40; ++frame) {
      world.step(1.0 / 60);
      touching += frame >= 20 && world.report().contacts > 0;
      lowest = std::min(lowest, lowest_in_triangles(world, cloth, shape));
    }
    EXPECT_GT(lowest, 0) << shape_name(shape);
    EXPECT_GE(touching, 17) << shape_name(shape);
    EXPECT_GT(world.center_of_mass(cloth).y, -0.5) << "it slid off";
  }
}

TEST(ColliderElementContacts, ACoarseClothStaysOutsideATablesCorner) {
  const Shape table = Box{{-0.5f, -0.05f, -0.5f}, {0.5f, 0.05f, 0.5f}};
  World world;
  world.add_collider(table, {.friction = 0.6f});
  const ObjectId cloth = world.add_cloth(grid(5, 5, 0.8), thick_cloth(), at(-0.1, 0.1, -0.07));
  double lowest = 1;
  for (int frame = 0; frame < 60; ++frame) {
    world.step(1.0 / 60);
    lowest = std::min(lowest, lowest_in_triangles(world, cloth, table));
  }
  EXPECT_GT(lowest, 0);
}

/// A ball of 0.22 m with bumps that are narrower than a triangle of 5 cm.
TriangleMesh bumpy_ball() {
  TriangleMesh mesh = sphere(3, 0.22);
  for (Vec3d& x : mesh.positions)
    x = x * (1 + 0.12 * std::sin(16 * x.x) * std::sin(16 * x.y + 1) * std::sin(16 * x.z + 2));
  return mesh;
}

// Cotton of half a millimeter, edges of 5 cm. Where it hits, the solver leaves some millimeters for a moment. Without
// contacts of elements, edges are 17 mm inside the box and 6 mm inside the bumps. Results are means of four positions.
// For a single one, chance decides whether it is 1 or 5 mm inside the cylinder in the end. The mean of sixteen is 3 mm, and
// 6 to 9 mm where it hits.
TEST(ColliderElementContacts, AThinClothStaysOutsideEdgesAndBumps) {
  const Shape shapes[] = {Box{{0, -0.25f, 0}, {0.25f, 0.25f, 0.25f}}, Cylinder{{0, -0.25f, 0}, 0.25f, 0.25f},
                          SignedDistanceField(bumpy_ball(), 0.01)};
  for (const Shape& shape : shapes) {
    const double top = shape_bounds(shape).hi.y;
    double lowest = 0, at_end = 0;
    for (int position = 0; position < 4; ++position) {
      World world({.wind = {.air_density = 0}});  // it lands sooner
      world.add_collider(shape, {.friction = 0.4f});
      const Vec3d at{0.013 + 0.002 * position, top + 0.02, 0.007 - 0.001 * position};
      const ObjectId cloth =
          world.add_cloth(grid(20, 20, 1), material::cotton, {.transform = {.translation = at}});
      double lowest_here = 1;
      for (int frame = 0; frame < 70; ++frame) {
        world.step(1.0 / 60);
        const double now = lowest_in_triangles(world, cloth, shape);
        lowest_here = std::min(lowest_here, now);
        if (frame >= 50) at_end += now / 80;
      }
      lowest += lowest_here / 4;
    }
    EXPECT_GT(lowest, -0.010) << shape_name(shape);
    EXPECT_GT(at_end, -0.004) << shape_name(shape);
  }
}

// Nodes 10 cm apart, a bar of 1 cm.
TEST(ColliderElementContacts, ARopeHangsOverAThinBar) {
  const Shape bar = Capsule{{}, 0.01f, 0.5f};
  const Transform across{.rotation = Quatd::from_axis_angle({1, 0, 0}, 1.5707963267948966)};
  World world;
  world.add_collider(bar, {.friction = 1, .motion = ColliderMotion::fixed(across)});
  const Vec3d points[] = {{-0.55, 0.3, 0}, {0.55, 0.3, 0}};
  const ObjectId rope = world.add_rope(points, 11, {.radius = 0.005f, .density = 1100, .friction = 1});
  double lowest = 1;
  for (int frame = 0; frame < 90; ++frame) {
    world.step(1.0 / 60);
    const auto x = world.positions(rope);
    float highest = -10;
    for (const Vec3f& node : x) highest = std::max(highest, node.y);
    ASSERT_GT(highest, -0.1f) << "it fell through, or off, in frame " << frame;
  }
  // The bar's own frame has it along Y.
  std::vector<Vec3d> local;
  for (const Vec3f& x : world.positions(rope)) local.push_back(rotate(conjugate(across.rotation), Vec3d(x)));
  for (std::size_t i = 0; i + 1 < local.size(); ++i)
    for (int s = 0; s <= 50; ++s)
      lowest = std::min(
          lowest, surface_distance(bar, local[i] * (1 - s / 50.0) + local[i + 1] * (s / 50.0)).distance);
  EXPECT_GT(lowest, 0);
}

// A taut triangle stops a ball that is fast enough to pass it within a substep.
TEST(ColliderElementContacts, AFastBallDoesNotPassATriangle) {
  World world({.gravity = {}});
  const auto motion = ColliderMotion::callback([](double t) {
    return Transform{.translation = {0.13, 0.5 - 60 * t, 0.11}};
  });
  world.add_collider(Sphere{{}, 0.02f}, {.motion = motion});
  const ObjectId cloth = world.add_cloth(grid(4, 4, 1.5), thick_cloth());
  run(world, 2.0 / 60);
  // The ball is at -1.5 m: the object that it hit is below it, none above.
  const Vec3d center = world.collider_pose(world.colliders()[0]).translation;
  float lowest = 10;
  for (const Vec3f& x : world.positions(cloth)) lowest = std::min(lowest, x.y);
  EXPECT_LT(world.center_of_mass(cloth).y, -0.05);
  EXPECT_GT(lowest_in_triangles(world, cloth, Sphere{Vec3f(center), 0.02f}), 0);
}

// Fine enough for the ball below it: no contacts in addition to those of its vertices.
TEST(ColliderElementContacts, AFineClothNeedsNone) {
  World world;
  world.add_collider(Sphere{{}, 0.5f});
  const ObjectId cloth = world.add_cloth(grid(31, 31, 0.6), thick_cloth(), at(0, 0.51, 0));
  run(world, 0.5);
  EXPECT_LE(world.report().contacts, world.positions(cloth).size());
  for (const ContactEvent& event : world.contacts()) EXPECT_NEAR(length(event.point), 0.5f, 1e-4f);
}

// A sheet of two triangles whose center lies on a ball: the ball supports its weight, and the sheet slides
// according to mu.
TEST(ColliderElementContacts, TheBallCarriesTheWeight) {
  World world;
  world.add_collider(Sphere{{0, -0.1f, 0}, 0.1f}, {.friction = 1});
  ClothMaterial stiff = thick_cloth();
  stiff.friction = 1;
  stiff.bending_stiffness = 10;
  stiff.areal_density = 1;
  stiff.damping = 20;
  const ObjectId cloth = world.add_cloth(grid(2, 2, 0.4), stiff, at(0, 0.004, 0));
  run(world, 0.3);
  double impulse = 0;
  for (const ContactEvent& event : world.contacts()) {
    impulse += double(event.impulse);
    EXPECT_TRUE(event.other_is_collider);
    EXPECT_GT(event.normal.y, 0.9f);
    EXPECT_NEAR(length(event.point - Vec3f(0, -0.1f, 0)), 0.1f, 5e-3f);
  }
  const double weight = world.total_mass(cloth) * 9.81;
  EXPECT_NEAR(impulse * 600, weight, 0.1 * weight);
}

// A signed distance field as a collider of a world.

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
  return world.add_cloth(grid(25, 25, 0.8), material, at(0.01, 0.2, 0.02));
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
  const ObjectId grain = world.add_grains(std::vector<Vec3d>{{0, 1.15, 0}}, {.radius = 0.05f, .friction = 1});
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

}  // namespace souple::test_world_colliders
