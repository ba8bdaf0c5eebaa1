#include "checks.h"
#include "souple/error.h"
#include "souple/geometry/builders.h"
#include "souple/geometry/embedding.h"
#include "souple/geometry/lattice.h"
#include "souple/math/mat3.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace souple::test_geometry_embedding {

// Any affine motion of the tets must move the points exactly, inside or outside.
void expect_affine_exact(const std::vector<Vec3d>& points, TetMesh mesh, const Embedding& embedding) {
  const Mat3d a{{1.2, 0.3, -0.1}, {0.4, 0.8, 0.2}, {-0.5, 0.1, 1.5}};
  const Vec3d b{10, -3, 2};
  for (Vec3d& p : mesh.positions) p = a * p + b;
  std::vector<Vec3d> moved(points.size());
  apply<double>(embedding, mesh.positions, moved);
  for (std::size_t i = 0; i < points.size(); ++i)
    EXPECT_NEAR(length(moved[i] - (a * points[i] + b)), 0, 1e-12);
}

TEST(Embedding, OfRandomPointsInABarIsExactAndInside) {
  const TetMesh bar = tet_bar(6, 3, 4, {2, 2, 2});
  check::Random random(1);
  std::vector<Vec3d> points;
  points.reserve(2000 + bar.positions.size());
  for (int i = 0; i < 2000; ++i) points.push_back(random.in_cube());
  points.insert(points.end(), bar.positions.begin(), bar.positions.end());
  const Embedding embedding = embed(points, bar);
  EXPECT_EQ(embedding.outside, 0u);
  for (const auto& w : embedding.weights) {
    EXPECT_NEAR(w[0] + w[1] + w[2] + w[3], 1, 1e-12);
    for (const double x : w) EXPECT_GE(x, -1e-9);
  }
  expect_affine_exact(points, bar, embedding);
}

TEST(Embedding, OutsidePointsHangOnTheNearestTet) {
  const TetMesh bar = tet_bar(4, 4, 4, {2, 2, 2});
  const std::vector<Vec3d> points{{3, 0.1, 0.2}, {-1.5, -1.5, -1.5}, {0, 40, 0}, {0.2, 0.1, 0.3}};
  const Embedding embedding = embed(points, bar);
  EXPECT_EQ(embedding.outside, 3u);
  EXPECT_NEAR(embedding.largest_distance, 39, 1e-12);
  expect_affine_exact(points, bar, embedding);
  // The host tet of (3, 0.1, 0.2) touches the bar's face x = 1 at the point's projection.
  const Tet& host = embedding.vertices[0];
  int on_face = 0;
  for (const std::uint32_t v : host) on_face += bar.positions[v].x == 1.0 ? 1 : 0;
  EXPECT_EQ(on_face, 3);
}

TEST(Embedding, NearestAgreesWithTryingAllTets) {
  // A lattice of a torus has a hole, so that the nearest tet is not in the nearest cube.
  const TetMesh mesh = build_lattice(torus(1.0, 0.2, 32, 12), {.cell_size = 0.15}).mesh;
  check::Random random(7);
  std::vector<Vec3d> points;
  points.reserve(300);
  for (int i = 0; i < 300; ++i) points.push_back(random.in_cube() * 2.0);
  const Embedding embedding = embed(points, mesh);
  EXPECT_GT(embedding.outside, 100u);
  for (std::size_t i = 0; i < points.size(); ++i) {
    // No point of a fine sampling of all tets may be nearer than the host's nearest point.
    const auto sampled = [&](const Tet& t) {
      double best = 1e300;
      for (int a = 0; a <= 6; ++a)
        for (int b = 0; a + b <= 6; ++b)
          for (int c = 0; a + b + c <= 6; ++c)
            best = std::min(best, length((mesh.positions[t[0]] * a + mesh.positions[t[1]] * b +
                                          mesh.positions[t[2]] * c + mesh.positions[t[3]] * (6 - a - b - c)) /
                                             6.0 -
                                         points[i]));
      return best;
    };
    double best = 1e300;
    for (const Tet& t : mesh.tets) best = std::min(best, sampled(t));
    EXPECT_LE(sampled(embedding.vertices[i]), best + 0.15 / 6);
    if (i >= 20) break;  // a few dozen suffice for this slow check
  }
}

TEST(Embedding, RefusesWhatCannotCarry) {
  TetMesh flat;
  flat.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
  flat.tets = {{0, 1, 2, 3}};
  EXPECT_THROW(embed(std::vector<Vec3d>{{0, 0, 0}}, flat), Error);
  EXPECT_THROW(embed(std::vector<Vec3d>{{0, 0, 0}}, TetMesh{}), Error);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(embed(std::vector<Vec3d>{{0, nan, 0}}, tet_bar(1, 1, 1, {1, 1, 1})), Error);
  EXPECT_THROW(embed(std::vector<Vec3d>{{0, -1e300, 1e300}}, tet_bar(1, 1, 1, {1, 1, 1})), Error);
  flat.tets = {{0, 1, 2, 9}};
  EXPECT_THROW(embed(std::vector<Vec3d>{{0, 0, 0}}, flat), Error);
}

}  // namespace souple::test_geometry_embedding
