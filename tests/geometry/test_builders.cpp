#include "checks.h"
#include "souple/error.h"
#include "souple/geometry/builders.h"
#include "souple/geometry/circle.h"
#include "tests/expect_error.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace souple::test_geometry_builders {

using check::area;
using check::euler_characteristic;
using check::is_watertight;
using check::volume;

TEST(Circle, EqualsCosineAndSineAndIsExactAtQuarters) {
  for (const int n : {1, 2, 3, 5, 7, 8, 64, 1000, 999983})
    for (const int k : {0, 1, 2, 3, n / 8, n / 4, n / 2, n - 1, n, 3 * n + 1}) {
      const CirclePoint p = circle_point(k, n);
      EXPECT_NEAR(p.cosine, std::cos(2 * pi * (k % n) / n), 1e-15);
      EXPECT_NEAR(p.sine, std::sin(2 * pi * (k % n) / n), 1e-15);
    }
  EXPECT_EQ(circle_point(1, 4).cosine, 0);
  EXPECT_EQ(circle_point(2, 4).sine, 0);
  EXPECT_EQ(circle_point(3, 4).sine, -1);
  EXPECT_EQ(circle_point(1, 8).cosine, circle_point(1, 8).sine);
}

TEST(Grid, HasTheStatedOrderSizeAndNormals) {
  const TriangleMesh mesh = grid(5, 3, 2.0f);
  ASSERT_EQ(mesh.positions.size(), 15u);
  ASSERT_EQ(mesh.triangles.size(), 16u);
  EXPECT_EQ(mesh.positions[0], (Vec3d{-1, 0, -0.5}));
  EXPECT_EQ(mesh.positions[4], (Vec3d{1, 0, -0.5}));
  EXPECT_EQ(mesh.positions[1 * 5 + 2], (Vec3d{0, 0, 0}));
  EXPECT_EQ(mesh.positions[14], (Vec3d{1, 0, 0.5}));
  EXPECT_DOUBLE_EQ(area(mesh), 2.0);
  for (const Triangle& t : mesh.triangles)
    EXPECT_GT(
        cross(mesh.positions[t[1]] - mesh.positions[t[0]], mesh.positions[t[2]] - mesh.positions[t[0]]).y, 0);
  EXPECT_EQ(euler_characteristic(mesh.triangles), 1);
  ASSERT_EQ(mesh.uvs.size(), 15u);
  EXPECT_FLOAT_EQ(mesh.uvs[14][0], 1.0f);
  EXPECT_FLOAT_EQ(mesh.uvs[14][1], 0.5f);
}

// Directions of the diagonals: +1 along x = z, -1 across it.
std::vector<int> diagonals(const TriangleMesh& mesh) {
  std::vector<int> result;
  for (const Edge& e : unique_edges(mesh.triangles)) {
    const Vec3d d = mesh.positions[e[1]] - mesh.positions[e[0]];
    if (d.x != 0 && d.z != 0) result.push_back(d.x * d.z > 0 ? 1 : -1);
  }
  return result;
}

TEST(Grid, DiagonalsAlternateOrNot) {
  int sum = 0;
  for (const int d : diagonals(grid(7, 7, 1))) sum += d;
  EXPECT_EQ(sum, 0);
  for (const int d : diagonals(grid(7, 7, 1, Diagonals::one_way))) EXPECT_EQ(d, 1);
  EXPECT_EQ(diagonals(grid(7, 7, 1)).size(), 36u);
}

TEST(Disk, AreaIsThatOfItsPolygon) {
  const TriangleMesh mesh = disk(4, 24, 0.5);
  EXPECT_EQ(mesh.positions.size(), 97u);
  EXPECT_NEAR(area(mesh), 0.5 * 24 * 0.25 * std::sin(2 * pi / 24), 1e-14);
  EXPECT_EQ(euler_characteristic(mesh.triangles), 1);
  EXPECT_EQ(boundary_edges(mesh.triangles).size(), 24u);
  for (const Triangle& t : mesh.triangles)
    EXPECT_GT(
        cross(mesh.positions[t[1]] - mesh.positions[t[0]], mesh.positions[t[2]] - mesh.positions[t[0]]).y, 0);
}

TEST(Sphere, ClosedAndConvergesToTheVolumeAndAreaOfABall) {
  double previous = 0;
  for (int s = 0; s <= 4; ++s) {
    const TriangleMesh mesh = sphere(s, 2.0);
    EXPECT_TRUE(is_watertight(mesh.triangles));
    EXPECT_EQ(euler_characteristic(mesh.triangles), 2);
    EXPECT_EQ(mesh.triangles.size(), 20u << (2 * s));
    for (const Vec3d& p : mesh.positions) EXPECT_NEAR(length(p), 2.0, 1e-14);
    const double error = 4.0 / 3 * pi * 8 - volume(mesh);
    EXPECT_GT(error, 0);
    if (s > 1) {
      EXPECT_NEAR(previous / error, 4.0, 0.4);  // second order
    }
    previous = error;
  }
  EXPECT_NEAR(volume(sphere(4, 2.0)), 4.0 / 3 * pi * 8, 0.1);
  EXPECT_NEAR(area(sphere(4, 2.0)), 16 * pi, 0.1);
}

TEST(Box, VolumeAndAreaAreExact) {
  for (const std::array<int, 3> n :
       {std::array<int, 3>{1, 1, 1}, {2, 2, 2}, {3, 1, 2}, {1, 4, 1}, {4, 3, 5}}) {
    const TriangleMesh mesh = box({1, 2, 3}, n);
    EXPECT_TRUE(is_watertight(mesh.triangles));
    EXPECT_EQ(euler_characteristic(mesh.triangles), 2);
    EXPECT_EQ(std::size_t(euler_characteristic(mesh.triangles)) + mesh.triangles.size() / 2,
              mesh.positions.size());  // every vertex is used
    EXPECT_NEAR(volume(mesh), 6, 1e-13);
    EXPECT_NEAR(area(mesh), 22, 1e-12);
  }
}

TEST(Torus, VolumeAndAreaByPappus) {
  const TriangleMesh mesh = torus(1.0, 0.25, 96, 48);
  EXPECT_TRUE(is_watertight(mesh.triangles));
  EXPECT_EQ(euler_characteristic(mesh.triangles), 0);
  EXPECT_NEAR(volume(mesh) / (2 * pi * pi * 0.0625), 1, 4e-3);
  EXPECT_NEAR(area(mesh) / (4 * pi * pi * 0.25), 1, 2e-3);
}

TEST(Capsule, VolumeAndHeight) {
  const TriangleMesh mesh = capsule(0.5, 2.0, 64, 24, 5);
  EXPECT_TRUE(is_watertight(mesh.triangles));
  EXPECT_EQ(euler_characteristic(mesh.triangles), 2);
  EXPECT_NEAR(volume(mesh) / (pi * 0.25 * 2 + 4.0 / 3 * pi * 0.125), 1, 4e-3);
  EXPECT_NEAR(area(mesh) / (2 * pi * 0.5 * 2 + 4 * pi * 0.25), 1, 2e-3);
  EXPECT_EQ(mesh.positions.front(), (Vec3d{0, -1.5, 0}));
  EXPECT_EQ(mesh.positions.back(), (Vec3d{0, 1.5, 0}));
}

TEST(Cylinder, VolumeAndAreaOfItsPrism) {
  const TriangleMesh mesh = cylinder(0.5, 2.0, 12, 4, 3);
  EXPECT_TRUE(is_watertight(mesh.triangles));
  EXPECT_EQ(euler_characteristic(mesh.triangles), 2);
  const double cap = 0.5 * 12 * 0.25 * std::sin(2 * pi / 12), rim = 12 * 2 * 0.5 * std::sin(pi / 12);
  EXPECT_NEAR(volume(mesh), 2 * cap, 1e-13);
  EXPECT_NEAR(area(mesh), 2 * cap + 2 * rim, 1e-13);
}

TEST(TetBar, FillsItsBoxWithPositiveTetsThatMatchAtEveryFace) {
  const TetMesh mesh = tet_bar(4, 3, 2, {2.0, 0.6, 0.3});
  EXPECT_EQ(mesh.tets.size(), 5u * 24);
  double sum = 0;
  for (const Tet& t : mesh.tets) {
    EXPECT_GT(check::tet_volume(mesh, t), 0);
    sum += check::tet_volume(mesh, t);
  }
  EXPECT_NEAR(sum, 0.36, 1e-14);
  TriangleMesh boundary{mesh.positions, surface_triangles(mesh.tets), {}, {}, {}, {}, {}};
  EXPECT_TRUE(is_watertight(boundary.triangles));
  EXPECT_NEAR(volume(boundary), 0.36, 1e-14);
  // Faces without a match would stay in the boundary inside the box and add to its area.
  EXPECT_NEAR(area(boundary), 2 * (2.0 * 0.6 + 0.6 * 0.3 + 0.3 * 2.0), 1e-13);
}

TEST(TetBall, FillsTheSphereWithPositiveTetsThatMatchAtEveryFace) {
  for (const int layers : {1, 2, 3}) {
    const TetMesh mesh = tet_ball(2, layers, 0.5);
    EXPECT_EQ(mesh.tets.size(), 320u * (3 * std::size_t(layers) - 2));
    double sum = 0, least = 1;
    for (const Tet& t : mesh.tets) {
      least = std::min(least, check::tet_volume(mesh, t));
      sum += check::tet_volume(mesh, t);
    }
    EXPECT_GT(least, 0) << layers;
    const TriangleMesh boundary = sphere(2, 0.5);
    EXPECT_NEAR(sum, volume(boundary), 1e-14);
    const TriangleMesh surface{mesh.positions, surface_triangles(mesh.tets), {}, {}, {}, {}, {}};
    EXPECT_TRUE(is_watertight(surface.triangles));
    EXPECT_NEAR(area(surface), area(boundary), 1e-13);
    EXPECT_NEAR(volume(surface), volume(boundary), 1e-14);
  }
}

TEST(Builders, RefuseWhatCannotBeBuilt) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  EXPECT_THROW(grid(0, 5, 1), Error);
  EXPECT_THROW(grid(5, 1, 1), Error);
  EXPECT_THROW(grid(5, 5, nan), Error);
  EXPECT_THROW(grid(5, 5, 0), Error);
  EXPECT_THROW(grid(2147483647, 2147483647, 1), Error);
  EXPECT_THROW(disk(0, 5, 1), Error);
  EXPECT_THROW(disk(2, 2, 1), Error);
  EXPECT_THROW(sphere(-1, 1), Error);
  EXPECT_THROW(sphere(2147483647, 1), Error);
  EXPECT_THROW(sphere(1, inf), Error);
  EXPECT_THROW(box({1, -1, 1}), Error);
  EXPECT_THROW(box({1, 1, 1}, 0), Error);
  EXPECT_THROW(box({1, 1, 1}, 100000), Error);
  EXPECT_THROW(torus(1, 1, 8, 8), Error);
  EXPECT_THROW(torus(1, 0.1, 2, 8), Error);
  EXPECT_THROW(capsule(1, 1, 8, 0), Error);
  EXPECT_THROW(cylinder(1, nan, 8), Error);
  EXPECT_THROW(tet_bar(1, 1, 0, {1, 1, 1}), Error);
  EXPECT_THROW(tet_bar(100000, 100000, 100000, {1, 1, 1}), Error);
  EXPECT_THROW(tet_ball(1, 0, 1), Error);
  EXPECT_THROW(tet_ball(-1, 1, 1), Error);
  EXPECT_THROW(tet_ball(20, 1, 1), Error);
  EXPECT_EQ(error_of([] { grid(0, 5, 1); }), "grid: columns is 0, expected at least 2");
}

}  // namespace souple::test_geometry_builders
