// Contacts of triangles and edges with colliders: coarse meshes do not sink in between their vertices.
#include "souple/souple.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

namespace souple::test_world_collider_element_contacts {

void run(World& world, double seconds) {
  for (int frame = 0; frame < std::lround(seconds * 60); ++frame) world.step(1.0 / 60);
}

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

ClothMaterial thick_cloth() {
  ClothMaterial material = material::cotton;
  material.thickness = 0.01f;
  return material;
}

// Edges of 0.2 m: four times the diameter of the ball.
TEST(ColliderElementContacts, ACoarseClothStaysOutsideASmallBall) {
  const Shape shapes[] = {Sphere{{0.03f, 0, 0.02f}, 0.05f}, SignedDistanceField(sphere(3, 0.05), 0.01)};
  for (const Shape& shape : shapes) {
    World world;
    world.add_collider(shape, {.friction = 1});
    const ObjectId cloth =
        world.add_cloth(grid(5, 5, 0.8), thick_cloth(), {.transform = {.translation = {0, 0.15, 0}}});
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
  const ObjectId cloth =
      world.add_cloth(grid(5, 5, 0.8), thick_cloth(), {.transform = {.translation = {-0.1, 0.1, -0.07}}});
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
// For a single one, chance decides whether it is 1 or 5 mm inside the cylinder in the end. The mean is 8 or 9 mm where
// it hits.
TEST(ColliderElementContacts, AThinClothStaysOutsideEdgesAndBumps) {
  const Shape shapes[] = {Box{{0, -0.25f, 0}, {0.25f, 0.25f, 0.25f}}, Cylinder{{0, -0.25f, 0}, 0.25f, 0.25f},
                          SignedDistanceField(bumpy_ball(), 0.01)};
  for (const Shape& shape : shapes) {
    const double top = shape_bounds(shape).hi.y;
    double lowest = 0, at_end = 0;
    for (int position = 0; position < 4; ++position) {
      World world;
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
    EXPECT_GT(at_end, -0.003) << shape_name(shape);
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
  const ObjectId cloth =
      world.add_cloth(grid(31, 31, 0.6), thick_cloth(), {.transform = {.translation = {0, 0.51, 0}}});
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
  const ObjectId cloth =
      world.add_cloth(grid(2, 2, 0.4), stiff, {.transform = {.translation = {0, 0.004, 0}}});
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

}  // namespace souple::test_world_collider_element_contacts
