#include "souple/souple.h"
#include "tests/physics/validation.h"

#include <cmath>
#include <optional>
#include <string>

#include <gtest/gtest.h>

// Objects on an inclined plane, and on another object that lies on one. Each sticks below the friction angle and slides
// above it with a = g (sin - mu cos). The slope is level and gravity is inclined.

namespace souple::test_physics_collision_slopes {

constexpr float mu = 0.4f;
constexpr double g = 9.81f;

enum class Body { cloth, soft, raft };
enum class Ground { plane, mesh, cloth, soft };
constexpr const char* body_names[] = {"cloth", "soft", "raft"};
constexpr const char* ground_names[] = {"plane", "mesh", "cloth", "soft"};

// The top of each ground is at y = 0; bodies start just above the contact distance.
void add_ground(World& world, Ground ground, std::optional<float> mu_k = {}) {
  if (ground == Ground::plane) world.add_collider(Plane{}, {.friction = mu, .kinetic_friction = mu_k});
  if (ground == Ground::mesh)
    world.add_obstacle(grid(41, 41, 4), {.thickness = 0.01f, .friction = mu, .kinetic_friction = mu_k});
  if (ground == Ground::cloth) {
    const ObjectId cloth =
        world.add_cloth(grid(37, 37, 4), {.thickness = 0.01f, .friction = mu, .kinetic_friction = mu_k});
    world.pin(cloth, all());
  }
  if (ground == Ground::soft) {
    const ObjectId slab = world.add_soft_body(
        tet_bar(12, 1, 4, {3.6, 0.2, 1.2}),
        {.young_modulus = 1e7f, .thickness = 0.01f, .friction = mu, .kinetic_friction = mu_k, .damping = 2},
        {.transform = {.translation = {0.4, -0.1, 0}}});
    world.pin(slab, in_box({-9, -0.3f, -9}, {9, -0.199f, 9}));
  }
}

ObjectId add_body(World& world, Body body, double above, std::optional<float> mu_k = {}) {
  const auto at = [&](double half) { return Transform{.translation = {-0.83, above + half, 0.02}}; };
  switch (body) {
    case Body::cloth:
      return world.add_cloth(grid(6, 6, 0.31), {.thickness = 0.01f, .friction = mu, .kinetic_friction = mu_k},
                             {.transform = at(0.0051)});
    case Body::soft:
      return world.add_soft_body(
          tet_bar(4, 2, 4, {0.3, 0.1, 0.3}),
          {.young_modulus = 1e6f, .thickness = 0.01f, .friction = mu, .kinetic_friction = mu_k, .damping = 2},
          {.transform = at(0.0551)});
    case Body::raft:
      break;
  }
  // Joined, and with so much rolling friction that they slide.
  std::vector<Vec3d> centers;
  centers.reserve(9);
  for (int x = 0; x < 3; ++x)
    for (int z = 0; z < 3; ++z) centers.push_back({0.05 * x, 0, 0.05 * z});
  const ObjectId raft = world.add_grains(
      centers, {.radius = 0.02f, .friction = mu, .kinetic_friction = mu_k, .rolling_friction = 10},
      {.transform = at(0.0201)});
  std::vector<std::pair<VertexRef, VertexRef>> ties;
  for (std::uint32_t a = 0; a < 9; ++a)
    for (std::uint32_t b = 0; b < a; ++b) ties.push_back({{raft, a}, {raft, b}});
  world.connect(ties, -1);
  return raft;
}

class Slope : public ::testing::TestWithParam<std::tuple<Body, Ground>> {};

constexpr const char* name = "inclined plane, of surfaces";

TEST_P(Slope, SticksAndSlidesAsMuSays) {
  const auto [body, ground] = GetParam();
  for (const double steepness : {0.9, 1.5}) {  // tan of the slope over mu
    const double angle = std::atan(steepness * double(mu));
    World world({.gravity = {float(g * std::sin(angle)), float(-g * std::cos(angle)), 0}});
    add_ground(world, ground);
    const ObjectId id = add_body(world, body, ground == Ground::plane ? 0 : 0.005);
    const auto speed = [&] { return world.momentum(id).x / world.total_mass(id); };
    for (int frame = 0; frame < 42; ++frame) world.step(1.0 / 60);
    const double early = speed(), place = world.center_of_mass(id).x;
    for (int frame = 0; frame < 30; ++frame) world.step(1.0 / 60);
    const std::string what = std::string(body_names[int(body)]) + " on " + ground_names[int(ground)];
    const double acceleration = (speed() - early) / 0.5;
    if (steepness < 1) {
      validate_below(name, what + ": creep at tan = 0.9 mu in 0.5 s [m]",
                     std::fabs(world.center_of_mass(id).x - place), 1e-3);
      EXPECT_NEAR(acceleration, 0, 0.01);
    } else {
      validate_relative(name, what + ": acceleration at tan = 1.5 mu [m/s^2]", acceleration,
                        g * (std::sin(angle) - double(mu) * std::cos(angle)), 0.01);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Everything, Slope,
                         ::testing::Combine(::testing::Values(Body::cloth, Body::soft, Body::raft),
                                            ::testing::Values(Ground::plane, Ground::mesh, Ground::cloth,
                                                              Ground::soft)),
                         [](const auto& one) {
                           return std::string(body_names[int(std::get<0>(one.param))]) + "_on_" +
                                  ground_names[int(std::get<1>(one.param))];
                         });

// Between the two friction angles an object stays where it lies, and goes on sliding once it slides.
TEST_P(Slope, GoesOnSlidingWithKineticFriction) {
  const auto [body, ground] = GetParam();
  constexpr float mu_k = mu / 2;
  const double angle = std::atan(0.75 * double(mu));
  for (const bool pushed : {false, true}) {
    World world;
    add_ground(world, ground, mu_k);
    const ObjectId id = add_body(world, body, ground == Ground::plane ? 0 : 0.005, mu_k);
    const auto speed = [&] { return world.momentum(id).x / world.total_mass(id); };
    for (int frame = 0; frame < 30; ++frame) world.step(1.0 / 60);
    Settings tilted = world.settings();
    tilted.gravity = {float(g * std::sin(angle)), float(-g * std::cos(angle)), 0};
    world.set_settings(tilted);
    for (int frame = 0; frame < 30; ++frame) world.step(1.0 / 60);
    const std::string what = std::string(body_names[int(body)]) + " on " + ground_names[int(ground)];
    if (!pushed) {
      EXPECT_NEAR(speed(), 0, 0.005) << what;
      continue;
    }
    std::vector<Vec3f> v(world.velocities(id).begin(), world.velocities(id).end());
    for (Vec3f& one : v) one.x += 0.3f;
    world.set_velocities(id, v);
    for (int frame = 0; frame < 12; ++frame) world.step(1.0 / 60);
    const double early = speed();
    for (int frame = 0; frame < 18; ++frame) world.step(1.0 / 60);
    validate_relative(name, what + ": acceleration at tan = 0.75 mu while sliding with mu / 2 [m/s^2]",
                      (speed() - early) / 0.3, g * (std::sin(angle) - double(mu_k) * std::cos(angle)), 0.03);
  }
}

// Objects that slide without friction over triangles of one plane do not feel the edges between them.
TEST(FlatMesh, EdgesDoNotBrake) {
  for (const double speed : {0.5, 3.0}) {
    World world;
    world.add_obstacle(grid(41, 41, 4), {.thickness = 0.01f, .friction = 0});
    const std::vector<Vec3d> start{{-1.9, 0.025, 0.013}};
    const ObjectId grain = world.add_grains(start, {.radius = 0.02f, .friction = 0});
    const std::vector<Vec3f> v{{float(speed), 0, float(speed / 5)}};
    world.set_velocities(grain, v);
    for (int frame = 0; frame < 60; ++frame) {
      world.step(1.0 / 60);
      EXPECT_NEAR(double(world.velocities(grain)[0].y), 0, 1e-4) << "frame " << frame;
    }
    EXPECT_NEAR(double(world.velocities(grain)[0].x), speed, 1e-4 * speed);
    EXPECT_NEAR(double(world.velocities(grain)[0].z), speed / 5, 1e-4 * speed);
  }
}

// The origin and four points around it, at height `x_side` where x = +-1 and `z_side` where z = +-1.
TriangleMesh creased(double x_side, double z_side) {
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 0}, {1, x_side, 0}, {0, z_side, 1}, {-1, x_side, 0}, {0, z_side, -1}};
  mesh.triangles = {{0, 2, 1}, {0, 3, 2}, {0, 4, 3}, {0, 1, 4}};
  return mesh;
}

// An object is supported on the middle of a ridge or valley, on a tip or on the border of a sheet. It lies at the
// contact distance from the nearest point.
TEST(CreasedMesh, HoldsWhatLiesOnAnEdgeOrACorner) {
  struct Case {
    const char* what;
    TriangleMesh mesh;
    double height;
  };
  constexpr double r = 0.025;
  TriangleMesh border = grid(2, 2, 1);
  for (Vec3d& x : border.positions) x.x += 0.5;
  const Case cases[] = {{"ridge", creased(-0.3, 0), r},
                        {"valley", creased(0.3, 0), r * std::sqrt(1 + 0.3 * 0.3)},
                        {"tip", creased(-0.3, -0.3), r},
                        {"border", border, r}};
  for (const Case& one : cases) {
    World world;
    world.add_obstacle(one.mesh, {.thickness = 0.01f, .friction = 1});
    const std::vector<Vec3d> start{{0, one.height + 0.001, 0}};
    const ObjectId grain = world.add_grains(start, {.radius = 0.02f, .friction = 1});
    for (int frame = 0; frame < 60; ++frame) world.step(1.0 / 60);
    EXPECT_NEAR(double(world.positions(grain)[0].y), one.height, 1e-4) << one.what;
  }
}

}  // namespace souple::test_physics_collision_slopes
