#include "tests/world/scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

// Rigid bodies on triangles of obstacles and cloth.

namespace souple::test_world_rigid_obstacles {

constexpr double pi = 3.14159265358979323846;

/// A ball of meridians and circles, 2 * rows x rows.
TriangleMesh globe(double radius, int rows) {
  const int columns = 2 * rows;
  TriangleMesh mesh;
  mesh.positions.push_back({0, radius, 0});
  for (int i = 1; i < rows; ++i)
    for (int j = 0; j < columns; ++j) {
      const double down = pi * i / rows, around = 2 * pi * j / columns;
      mesh.positions.push_back(
          Vec3d{std::sin(down) * std::cos(around), std::cos(down), std::sin(down) * std::sin(around)} *
          radius);
    }
  mesh.positions.push_back({0, -radius, 0});
  const auto at_row = [&](int i, int j) {
    if (i == 0) return 0u;
    if (i == rows) return static_cast<std::uint32_t>(mesh.positions.size() - 1);
    return static_cast<std::uint32_t>(1 + (i - 1) * columns + j % columns);
  };
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < columns; ++j) {
      if (i > 0) mesh.triangles.push_back({at_row(i, j), at_row(i, j + 1), at_row(i + 1, j)});
      if (i + 1 < rows) mesh.triangles.push_back({at_row(i, j + 1), at_row(i + 1, j + 1), at_row(i + 1, j)});
    }
  return mesh;
}

ObjectId add_floor(World& world, const std::string& kind) {
  if (kind == "slab") return world.add_obstacle(box({4, 0.4, 4}), {}, {}, at(0, -0.2, 0));
  const int n = kind == "coarse" ? 3 : 41;
  return world.add_obstacle(grid(n, n, 4));
}

TEST(RigidOnObstacles, MeshesComeToRestOnTheSurface) {
  const std::vector<TriangleMesh> meshes{box({0.7, 0.7, 0.7}), globe(0.35, 6), globe(0.35, 24)};
  for (const std::string floor : {"coarse", "fine", "slab"})
    for (const double height : {0.15, 2.0}) {
      World world({.threads = 1});
      add_floor(world, floor);
      std::vector<ObjectId> bodies;
      for (std::size_t k = 0; k < meshes.size(); ++k)
        bodies.push_back(
            world.add_rigid_body(meshes[k], {}, at(1.2 * static_cast<double>(k) - 1.1, 0.35 + height, 0.1)));
      for (int frame = 0; frame < std::lround(60 * (2 + std::sqrt(2 * height / 9.81))); ++frame)
        ASSERT_EQ(world.step(1.0 / 60).message, "");
      for (const ObjectId body : bodies) {
        const auto x = world.positions(body);
        const Vec3f lowest =
            *std::min_element(x.begin(), x.end(), [](const Vec3f& a, const Vec3f& b) { return a.y < b.y; });
        EXPECT_NEAR(lowest.y, 0, 0.002) << floor << height << world.name(body);
        EXPECT_LT(length(world.rigid_body(body).velocity), 1e-3) << floor << height << world.name(body);
        EXPECT_LT(length(world.rigid_body(body).angular_velocity), 1e-3)
            << floor << height << world.name(body);
      }
    }
}

TEST(RigidOnObstacles, RoundBodiesRollAsOnAPlane) {
  const double slope = 3 * pi / 180;
  const Transform down{{}, Quatd::from_axis_angle({0, 0, 1}, -slope), 1};
  for (const Shape& shape : {Shape(Sphere{{}, 0.1f}), Shape(Cylinder{.radius = 0.1f, .half_height = 0.1f})}) {
    const bool ball = std::holds_alternative<Sphere>(shape);
    World world({.threads = 1});
    world.add_obstacle(grid(21, 21, 12), {}, {}, {.transform = down});
    ObjectOptions options = at(down.point({0, 0.1, 0}));
    options.transform.rotation = down.rotation * Quatd::from_axis_angle({1, 0, 0}, pi / 2);
    const ObjectId body = world.add_rigid_body(shape, {}, options);
    run(world, 2);
    const double theory = 9.81 * std::sin(slope) * 2 / (ball ? 1.4 : 1.5);
    EXPECT_NEAR(length(world.rigid_body(body).velocity), theory, 0.02 * theory) << ball;
  }
  const TriangleMesh floor = grid(61, 61, 12);
  const std::vector<Vec3f> low(floor.positions.begin(), floor.positions.end());
  std::vector<Vec3f> high = low;
  for (Vec3f& x : high) x.y += 0.4f;
  for (const bool rises : {false, true}) {
    World world({.threads = 1});
    ObstacleMotion motion;
    if (rises) motion.sequence = {.frames = {low, high}, .frame_rate = 0.5};
    world.add_obstacle(floor, {}, motion);
    const ObjectId ball = world.add_rigid_body(Sphere{{}, 0.1f}, {},
                                               {.transform = {.translation = {-2, 0.1, 0.013}},
                                                .velocity = {2, 0, 0.2f},
                                                .angular_velocity = {2, 0, -20}});
    run(world, 2);
    EXPECT_NEAR(world.rigid_body(ball).velocity.x, 2, 0.02) << rises;
  }
}

/// Speed and angular speed after 2 s on a plane or a taut cloth that slopes down along x [m/s, rad/s].
std::array<double, 2> roll(const Shape& shape, bool on_cloth, double slope, double speed) {
  World world({.threads = 1});
  const Transform down{{}, Quatd::from_axis_angle({0, 0, 1}, -slope), 1};
  double above = 0.1;
  if (on_cloth) {
    const ObjectId cloth = world.add_cloth(grid(51, 9, 10), {}, {.transform = down});
    world.pin(cloth, all());
    above = 0.1015;
  } else {
    world.add_collider(Plane{Vec3f(rotate(down.rotation, Vec3d{0, 1, 0}))});
  }
  const bool is_ball = std::holds_alternative<Sphere>(shape);
  const double aside = is_ball ? 0.1 * speed : 0;
  const ObjectId body = world.add_rigid_body(
      shape, {},
      {.transform = {down.point({-3, above, 0.013}),
                     down.rotation * Quatd::from_axis_angle({1, 0, 0}, is_ball ? 0.3 : pi / 2), 1},
       .velocity = Vec3f(rotate(down.rotation, Vec3d{speed, 0, aside})),
       .angular_velocity = Vec3f(rotate(down.rotation, Vec3d{aside / 0.1, 0, -speed / 0.1}))});
  run(world, 2);
  const RigidBodyState state = world.rigid_body(body);
  return {length(Vec3d(state.velocity)), length(Vec3d(state.angular_velocity))};
}

TEST(RigidOnCloth, RoundBodiesRollAsOnAPlane) {
  const std::vector<Shape> shapes{Sphere{{}, 0.1f}, Capsule{.radius = 0.1f, .half_height = 0.2f},
                                  Cylinder{.radius = 0.1f, .half_height = 0.2f}};
  for (std::size_t k = 0; k < shapes.size(); ++k)
    for (const double slope : {0.0, 3 * pi / 180}) {
      const double speed = slope > 0 ? 0 : 2;
      const auto on_cloth = roll(shapes[k], true, slope, speed),
                 on_plane = roll(shapes[k], false, slope, speed);
      const double theory =
          k == 1 || slope == 0 ? on_plane[0] : 9.81 * std::sin(slope) * 2 / (k == 0 ? 1.4 : 1.5);
      EXPECT_NEAR(on_cloth[0], theory, 0.02 * theory) << k << slope;
      EXPECT_NEAR(on_cloth[1], on_plane[1], 0.02 * on_plane[1]) << k << slope;
    }
}

TEST(RigidOnObstacles, AMovingObstacleCarriesABoxAndIsNamedByItsContacts) {
  World world({.threads = 1});
  const std::vector<PoseKey> keys{{0, {}, {}}, {1, {1, 0, 0}, {}}, {2, {2, 0, 0}, {}}};
  const ObjectId belt = world.add_obstacle(box({1, 0.2, 1}, 4), {}, {.pose = ColliderMotion::keyframes(keys)},
                                           {.name = "belt", .transform = {.translation = {0, -0.1, 0}}});
  const ObjectId crate =
      world.add_rigid_body(small_box, {}, {.transform = {.translation = {0, 0.1, 0}}, .velocity = {1, 0, 0}});
  run(world, 1);
  EXPECT_NEAR(world.rigid_body(crate).pose.translation.x, 1, 1e-3);
  const auto contacts = world.contacts();
  ASSERT_FALSE(contacts.empty());
  for (const ContactEvent& contact : contacts) {
    EXPECT_EQ(contact.other, "belt");
    const Vec3f vertex = world.positions(belt)[contact.other_vertex];
    EXPECT_LT(length(vertex - contact.point), 0.2f);
  }
}

TEST(RigidOnObstacles, ASnapshotHoldsTheirContacts) {
  const auto build = [] {
    World world({.threads = 1});
    add_floor(world, "fine");
    world.add_rigid_body(globe(0.35, 6), {},
                         {.transform = {.translation = {0, 0.5, 0}}, .velocity = {1, 0, 0.5f}});
    return world;
  };
  expect_resumes(build, 0.6, 0.5);
}

}  // namespace souple::test_world_rigid_obstacles
