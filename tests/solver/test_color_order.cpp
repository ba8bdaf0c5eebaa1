#include "souple/constraints/distance.h"
#include "souple/solver/set_projector.h"
#include "souple/world/world.h"
#include "tests/solver/meshes_to_color.h"

#include <algorithm>
#include <cstdio>

#include <gtest/gtest.h>

// The order of Gauss-Seidel determines stability: a rigid cloth whose constraints are solved vertex by vertex
// explodes within frames. With the colors of color_constraints it must come to rest.

namespace souple::test_solver_color_order {

struct Strain {
  double end = 0, ever = 0;
};

// A cloth of n x n vertices, 2 m wide, with rigid edges and rigid distances across them, one row pinned. It
// starts horizontal, swings down and hangs. 10 s, drag 0.1/s, ten substeps of one iteration.
Strain hang(int n) {
  World world({.substeps = 10, .drag = 0.1f});
  const ObjectId cloth =
      world.add_cloth(grid(n, n, 2), ClothMaterial{.membrane_stiffness = 0, .bending_stiffness = 0});
  std::vector<std::uint32_t> row;
  for (std::uint32_t column = 0; column < static_cast<std::uint32_t>(n); ++column) row.push_back(column);
  world.pin(cloth, vertices(row));
  const TriangleMesh mesh = world.mesh(cloth);
  auto links = std::make_unique<SetProjector<Distance>>();
  const auto link = [&](std::uint32_t a, std::uint32_t b) {
    links->add({world.particle(cloth, a), world.particle(cloth, b)},
               {static_cast<float>(length(mesh.positions[a] - mesh.positions[b]))});
  };
  for (const Edge& edge : test::springs(mesh)) link(edge[0], edge[1]);
  world.add_projector(std::move(links));
  Strain strain;
  for (int frame = 0; frame < 600; ++frame) {
    const StepReport& report = world.step(1.0 / 60);
    EXPECT_TRUE(report.ok()) << "frame " << frame;
    strain.end = report.largest_strain;
    strain.ever = std::max(strain.ever, strain.end);
  }
  return strain;
}

void expect_bounded(int n, double end, double ever) {
  const Strain strain = hang(n);
  std::printf("strain of %d x %d: %.3f in the end, %.3f ever\n", n, n, strain.end, strain.ever);
  EXPECT_LT(strain.end, end);
  EXPECT_LT(strain.ever, ever);
}

TEST(ColorOrder, RigidClothOf50HangsStill) {
  expect_bounded(50, 0.08, 0.25);
}

TEST(ColorOrder, RigidClothOf100HangsStillSlow) {
  expect_bounded(100, 0.3, 1.2);
}

TEST(ColorOrder, RigidClothOf200HangsStillSlow) {
  expect_bounded(200, 1.5, 4);
}

}  // namespace souple::test_solver_color_order
