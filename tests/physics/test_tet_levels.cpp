#include "souple/souple.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

// Bodies of stiff, fine tets, which a coarse lattice carries between sweeps (souple/multilevel/tet_levels.h).

namespace souple::test_physics_tet_levels {

constexpr double dt = 1.0 / 60, cell = 0.02;

double top_speed(const World& world, ObjectId object) {
  double top = 0;
  for (const Vec3f& v : world.velocities(object)) top = std::max(top, static_cast<double>(length(v)));
  return top;
}

/// A bar of 30 x 6 x 6 cells, pinned at one end, under gravity across or along it: how far the other end sags. [m]
double sag(float young_modulus, const Vec3f& gravity, float drag, const Settings& with) {
  Settings settings = with;
  settings.gravity = gravity, settings.drag = drag;
  World world(settings);
  const TetMesh mesh = tet_bar(30, 6, 6, {30 * cell, 6 * cell, 6 * cell});
  const ObjectId bar = world.add_soft_body(mesh, {.young_modulus = young_modulus});
  const float end = static_cast<float>(15 * cell);
  world.pin(bar, in_box({-end - 1e-3f, -1, -1}, {-end + 1e-3f, 1, 1}));
  for (int frame = 0; frame < 45; ++frame) EXPECT_TRUE(world.step(dt).ok());
  EXPECT_LT(top_speed(world, bar), 0.005);
  double sum = 0, count = 0;
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    if (mesh.positions[i].x < 15 * cell - 1e-4) continue;
    sum += dot(Vec3d(world.positions(bar)[i]) - mesh.positions[i], Vec3d(gravity)) / 9.81, ++count;
  }
  return sum / count;
}

// Sweeps alone leave such bars too soft (docs/notes/solvers.md, Tet levels). At rest the level leaves about g h^2 / 2 = 0.014 mm too little, of
// 12 mm and, hanging at 1e6 Pa, of 1.7 mm.
TEST(TetLevels, AFineBarSagsAsFarAsItsMaterial) {
  const Settings converged{.substeps = 200, .solver = {.kind = SolverKind::gauss_seidel}};
  const Vec3f across{0, -9.81f, 0}, along{9.81f, 0, 0};
  EXPECT_NEAR(sag(1e6f, across, 20, {}) / sag(1e6f, across, 20, converged), 1, 0.03);
  EXPECT_NEAR(sag(1e6f, along, 80, {}) / sag(1e6f, along, 80, converged), 1, 0.05);
  EXPECT_NEAR(sag(1e7f, across, 40, {}) / sag(1e7f, across, 40, converged), 1, 0.08);
}

TEST(TetLevels, ASpinningBodyKeepsItsMomentum) {
  World world({.gravity = {0, 0, 0}});
  const TetMesh mesh = tet_bar(20, 10, 10, {20 * cell, 10 * cell, 10 * cell});
  const ObjectId body = world.add_soft_body(mesh, {.young_modulus = 1e7f});
  std::vector<Vec3f> velocities;
  for (const Vec3d& x : mesh.positions)
    velocities.push_back(cross(Vec3f{3, 8, 5}, Vec3f(x)) + Vec3f{1, 2, 3});
  world.set_velocities(body, velocities);
  const auto spin = [&] {
    const Vec3f center(world.center_of_mass(body));
    Vec3d sum{};
    for (std::size_t i = 0; i < mesh.positions.size(); ++i)
      sum += Vec3d(cross(world.positions(body)[i] - center, world.velocities(body)[i]));
    return sum;
  };
  const Vec3d before = spin();
  for (int frame = 0; frame < 30; ++frame) ASSERT_TRUE(world.step(dt).ok());
  const Vec3d momentum = world.momentum(body) * (1 / world.total_mass(body));
  EXPECT_NEAR(momentum.x, 1, 1e-4);
  EXPECT_NEAR(momentum.y, 2, 1e-4);
  EXPECT_NEAR(momentum.z, 3, 1e-4);
  const Vec3d after = spin();  // implicit steps brake: plain Gauss-Seidel keeps as much
  EXPECT_NEAR(length(after) / length(before), 0.93, 0.03);
  EXPECT_GT(dot(after, before) / (length(after) * length(before)), 0.999);
  EXPECT_LT(world.report().largest_strain, 0.002);
}

// Plain Gauss-Seidel stretches a tet of a similar cube by 250 % at impact (docs/notes/solvers.md).
TEST(TetLevels, AStiffBodyFallsAndRests) {
  World world;
  world.add_collider(Plane{}, {.friction = 0.5f});
  const ObjectId cube =
      world.add_soft_body(tet_bar(10, 10, 10, {10 * cell, 10 * cell, 10 * cell}), {.young_modulus = 1e7f},
                          {.transform = {.translation = {0, 0.2, 0}}});
  double worst = 0;
  for (int frame = 0; frame < 90; ++frame) {
    ASSERT_TRUE(world.step(dt).ok());
    worst = std::max(worst, static_cast<double>(world.report().largest_strain));
  }
  EXPECT_LT(worst, 0.3);
  EXPECT_LT(top_speed(world, cube), 0.005);
  EXPECT_NEAR(world.center_of_mass(cube).y, 0.101, 1e-3);
  EXPECT_LT(world.report().largest_strain, 0.005);
}

// While bodies touch, each is swept, so that they share momentum exactly.
TEST(TetLevels, CollidingBodiesShareMomentum) {
  World world({.gravity = {0, 0, 0}});
  const TetMesh mesh = tet_bar(10, 10, 10, {10 * cell, 10 * cell, 10 * cell});
  const ObjectId first = world.add_soft_body(mesh, {.young_modulus = 1e7f});
  const ObjectId second =
      world.add_soft_body(mesh, {.young_modulus = 3e5f}, {.transform = {.translation = {0.25, 0.02, 0.01}}});
  world.set_velocities(first, std::vector<Vec3f>(mesh.positions.size(), Vec3f{3, 0, 0}));
  for (int frame = 0; frame < 20; ++frame) ASSERT_TRUE(world.step(dt).ok());
  const Vec3d momentum = world.momentum(first) + world.momentum(second);
  const double mass = world.total_mass(first);
  EXPECT_GT(world.momentum(second).x, 1.5 * mass);
  EXPECT_NEAR(momentum.x / mass, 3, 1e-3);
  EXPECT_NEAR(momentum.y / mass, 0, 1e-3);
  EXPECT_NEAR(momentum.z / mass, 0, 1e-3);
}

}  // namespace souple::test_physics_tet_levels
