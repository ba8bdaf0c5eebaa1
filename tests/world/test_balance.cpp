#include "souple/souple.h"

#include <algorithm>
#include <numeric>
#include <string>
#include <vector>

#include <gtest/gtest.h>

// ObjectReport: how far the forces of an object are out of balance, and Flag::not_converged.

namespace souple::test_world_balance {

constexpr double dt = 1.0 / 60;
constexpr int measured_every = 16;  // steps

/// 1 m of cotton that hangs by its upper row.
World hanging(int n, const Settings& settings) {
  World world(settings);
  TriangleMesh mesh = grid(n, n, 1.0);
  for (Vec3d& x : mesh.positions) x = {x.x, -x.z, 0};
  ObjectOptions options;
  options.name = "sheet";
  const ObjectId cloth = world.add_cloth(mesh, material::cotton, options);
  std::vector<std::uint32_t> row(static_cast<std::size_t>(n));
  std::iota(row.begin(), row.end(), 0u);
  world.pin(cloth, vertices(row));
  return world;
}

/// A bar of 3 x 12 x 3 cells, 1 m long, that hangs by its upper end.
World hanging_bar(float young_modulus, const Settings& settings) {
  World world(settings);
  const TetMesh mesh = tet_bar(3, 12, 3, {0.25, 1, 0.25});
  const ObjectId bar = world.add_soft_body(mesh, {.young_modulus = young_modulus, .poisson_ratio = 0.3f});
  std::vector<std::uint32_t> top;
  for (std::uint32_t i = 0; i < mesh.positions.size(); ++i)
    if (mesh.positions[i].y > 0.499) top.push_back(i);
  world.pin(bar, vertices(top));
  return world;
}

/// Largest `unbalanced` of any object after any step, and the number of flagged steps.
struct Watched {
  double unbalanced = 0;
  int flagged = 0;

  Watched(World& world, int steps) {
    for (int i = 0; i < steps; ++i) {
      const StepReport& report = world.step(dt);
      EXPECT_FALSE(report.objects.empty());
      for (const ObjectReport& object : report.objects) unbalanced = std::max(unbalanced, object.unbalanced);
      flagged += report.has(Flag::not_converged) ? 1 : 0;
    }
  }
};

constexpr SolverSettings plain{.kind = SolverKind::gauss_seidel};

// Plain sweeps leave it 13 % too long: 700 times the strain that its weight explains.
TEST(Balance, AClothThatHasNotConvergedIsNamed) {
  World world = hanging(100, {.solver = plain, .threads = 2});
  for (int i = 0; i < 4 * measured_every; ++i) world.step(dt);
  const StepReport& report = world.report();
  ASSERT_EQ(report.objects.size(), 1u);
  EXPECT_EQ(report.objects[0].name, "sheet");
  EXPECT_GT(report.objects[0].unbalanced, 0.9);
  EXPECT_GT(report.objects[0].stretch, 0.01);
  EXPECT_TRUE(report.has(Flag::not_converged));
  EXPECT_NE(report.message.find("sheet: the solver has not converged"), std::string::npos) << report.message;
  EXPECT_NE(report.message.find("automatic"), std::string::npos);
}

TEST(Balance, TheDefaultSolverConverges) {
  World world = hanging(100, {.threads = 2});
  EXPECT_EQ(Watched(world, 4 * measured_every).flagged, 0);
  EXPECT_LT(world.report().objects[0].unbalanced, 0.6);
  EXPECT_LT(world.report().objects[0].stretch, 5e-4);
}

// A soft bar falls into its load, stretches threefold and swings: each substep is solved nearly exactly.
TEST(Balance, AConvergedBodyIsInBalanceInMotion) {
  World world = hanging_bar(1e4f, {.threads = 2});
  EXPECT_LT(Watched(world, 60).unbalanced, 0.002);
}

TEST(Balance, AStiffBarIsSweptTooLittle) {
  World few = hanging_bar(1e7f, {.solver = plain, .threads = 2});
  EXPECT_GT(Watched(few, 64).flagged, 20);  // hangs three times as far as it should
  EXPECT_GT(few.report().objects[0].unbalanced, 0.3);
  World enough = hanging_bar(1e7f, {.threads = 2});
  const Watched watched(enough, 64);
  EXPECT_EQ(watched.flagged, 0);
  EXPECT_LT(watched.unbalanced, 0.05);
}

// The floor carries the block: what contacts move is no elastic force.
TEST(Balance, ContactsDoNotCountAsElasticForces) {
  World world({.threads = 2});
  ObjectOptions options;
  options.transform.translation = {0, 0.26, 0};
  world.add_soft_body(tet_bar(4, 4, 4, {0.5, 0.5, 0.5}), {.young_modulus = 1e5f, .damping = 5}, options);
  world.add_collider(Plane{});
  for (int i = 0; i < 150; ++i) world.step(dt);
  ASSERT_GT(world.report().contacts, 0u);
  EXPECT_LT(world.report().objects[0].unbalanced, 0.05);
  EXPECT_GT(world.report().objects[0].unbalanced, 0);
}

TEST(Balance, IsMeasuredOnRequestOnlyAndNeverInfluencesTheWorld) {
  World with = hanging(30, {.threads = 2}), without = hanging(30, {.measure_residuals = false, .threads = 2});
  World pbd = hanging(10, {.mode = Mode::pbd});
  for (int i = 0; i < 40; ++i) {
    with.step(dt);
    without.step(dt);
    pbd.step(dt);
  }
  EXPECT_EQ(with.report().objects.size(), 1u);
  EXPECT_TRUE(without.report().objects.empty());
  EXPECT_TRUE(pbd.report().objects.empty());
  EXPECT_EQ(with.hash(), without.hash());
}

TEST(Balance, ObjectsComeAndGo) {
  World world = hanging(12, {.threads = 1});
  const ObjectId rope = world.add_rope(std::vector<Vec3d>{{0, 2, 0}, {1, 2, 0}, {2, 2, 0}}, 20);
  world.add_grains(std::vector<Vec3d>{{0, 9, 0}});
  for (int i = 0; i < 20; ++i) world.step(dt);
  ASSERT_EQ(world.report().objects.size(), 2u);
  EXPECT_EQ(world.report().objects[1].name, world.name(rope));
  world.remove(rope);
  for (int i = 0; i < 20; ++i) world.step(dt);
  ASSERT_EQ(world.report().objects.size(), 1u);
}

}  // namespace souple::test_world_balance
