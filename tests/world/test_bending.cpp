#include "souple/geometry/adjacency.h"
#include "souple/geometry/builders.h"
#include "souple/world/world.h"
#include "tests/expect_error.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

// Comparison of the bending models at the level of the API: from a material to energies and motion.

namespace souple::test_world_bending {

constexpr double stiffness = 0.01;  // D [N m]
constexpr double side = 0.3;        // m
const double height = std::sqrt(0.75) * side;

/// Two equilateral triangles with a common edge along X, the second folded up by theta.
std::vector<Vec3f> folded(double theta) {
  return {{0, 0, 0},
          {static_cast<float>(side), 0, 0},
          {static_cast<float>(side / 2), 0, static_cast<float>(-height)},
          {static_cast<float>(side / 2), static_cast<float>(height * std::sin(theta)),
           static_cast<float>(height * std::cos(theta))}};
}

TriangleMesh hinge() {
  TriangleMesh mesh;
  for (const Vec3f& x : folded(0)) mesh.positions.emplace_back(x);
  mesh.triangles = {{0, 1, 2}, {1, 0, 3}};
  return mesh;
}

/// Energy relative to that of a hinge, D/2 |e|^2 / (A2 + A3) theta^2.
double relative_energy(BendingModel model, double theta) {
  World world;
  const ObjectId cloth = world.add_cloth(
      hinge(),
      {.membrane_stiffness = 100, .bending_stiffness = static_cast<float>(stiffness), .bending = model});
  world.set_positions(cloth, folded(theta));
  return world.elastic_energy() / (0.5 * stiffness * side * side / (height * side) * theta * theta);
}

TEST(Bending, ModelsStoreTheSameEnergyAtOneRadian) {
  EXPECT_NEAR(relative_energy(BendingModel::dihedral, 1), 1, 1e-3);
  EXPECT_NEAR(relative_energy(BendingModel::isometric, 1), 1, 0.1);
  EXPECT_NEAR(relative_energy(BendingModel::distance, 1), 1, 0.1);
}

TEST(Bending, AcrossEdgesIsLimpWhileFlat) {
  EXPECT_NEAR(relative_energy(BendingModel::distance, 0.1), 0.01, 0.001);
  EXPECT_GT(relative_energy(BendingModel::distance, 1.8), 2);
}

TEST(Bending, DistancesAreOneKindWithTheEdges) {
  World world({.substeps = 1});
  const TriangleMesh mesh = grid(20, 20, 1);
  world.add_cloth(mesh, {.bending = BendingModel::distance});
  const StepReport& report = world.step(0.01);
  ASSERT_EQ(report.kinds.size(), 1u);
  EXPECT_EQ(report.kinds[0].kind, "distance");
  EXPECT_EQ(report.kinds[0].count,
            unique_edges(mesh.triangles).size() + interior_edges(mesh.triangles).size());
}

/// The first triangle is pinned: largest drop of the tip of the second within a second.
double fall(const ClothMaterial& material) {
  World world({.substeps = 50});
  const ObjectId cloth = world.add_cloth(hinge(), material);
  world.pin(cloth, vertices({0, 1, 2}));
  double lowest = 0;
  for (int i = 0; i < 60; ++i) {
    world.step(1.0 / 60);
    lowest = std::min(lowest, static_cast<double>(world.positions(cloth)[3].y));
  }
  EXPECT_LT(world.report().largest_strain, 1e-4);
  return -lowest;
}

TEST(Bending, RigidDistancesHoldAFlapUp) {
  ClothMaterial material;
  material.bending = BendingModel::distance;
  material.membrane_stiffness = material.bending_stiffness = rigid;
  EXPECT_LT(fall(material), 0.05 * height);
  material.bending_stiffness = 0;
  EXPECT_GT(fall(material), 0.9 * height);
}

TEST(Bending, OnlyDistancesCanBeRigid) {
  World world;
  const auto add = [&](const ClothMaterial& material) { world.add_cloth(grid(3, 3, 1), material); };
  expect_error([&] { add({.bending_stiffness = rigid}); }, {"bending_stiffness", "inf"});
  expect_error([&] { add({.membrane_stiffness = rigid, .stretch = StretchModel::membrane}); },
               {"membrane_stiffness", "inf"});
  EXPECT_TRUE(world.objects().empty());
}

}  // namespace souple::test_world_bending
