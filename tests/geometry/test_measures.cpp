#include "checks.h"
#include "souple/geometry/builders.h"
#include "souple/geometry/measures.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace souple::test_geometry_measures {

TEST(Measures, OfABoxFarFromTheOrigin) {
  TriangleMesh mesh = box({0.1, 0.2, 0.3}, 3);
  for (Vec3d& p : mesh.positions) p += Vec3d{1000, -2000, 500};
  EXPECT_NEAR(enclosed_volume(mesh.positions, mesh.triangles), 0.006, 1e-13);
  EXPECT_NEAR(surface_area(mesh.positions, mesh.triangles), 0.22, 1e-12);
  const BoundingBox bounds = bounding_box(mesh.positions);
  EXPECT_NEAR(bounds.size().y, 0.2, 1e-12);
  EXPECT_NEAR(bounds.center().y, -2000, 1e-12);
  EXPECT_NEAR(bounds.diagonal(), std::sqrt(0.14), 1e-12);
  for (Triangle& t : mesh.triangles) std::swap(t[0], t[1]);
  EXPECT_NEAR(enclosed_volume(mesh.positions, mesh.triangles), -0.006, 1e-13);
}

TEST(Measures, BoundingBoxSkipsWhatIsNotFinite) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const BoundingBox bounds = bounding_box(std::vector<Vec3d>{{nan, 0, 0}, {1, 2, 3}, {2, 1, 4}});
  EXPECT_EQ(bounds.lo, (Vec3d{1, 1, 3}));
  EXPECT_EQ(bounds.hi, (Vec3d{2, 2, 4}));
  EXPECT_EQ(bounding_box({}).diagonal(), 0);
}

TEST(Measures, MassesSumToDensityTimesMeasureAndCenterStays) {
  const TriangleMesh sheet = disk(5, 20, 0.7);
  Vec3d moment;
  double sum = 0;
  const std::vector<double> masses = lumped_masses(sheet.positions, sheet.triangles, 0.2);
  for (std::size_t v = 0; v < masses.size(); ++v) {
    sum += masses[v];
    moment += sheet.positions[v] * masses[v];
  }
  EXPECT_NEAR(sum, 0.2 * surface_area(sheet.positions, sheet.triangles), 1e-14);
  EXPECT_NEAR(length(moment), 0, 1e-15);
  const TetMesh bar = tet_bar(4, 2, 2, {2, 1, 1});
  double tet_sum = 0;
  for (const double m : lumped_masses(bar, 1000)) tet_sum += m;
  EXPECT_NEAR(tet_sum, 2000, 1e-9);
  EXPECT_NEAR(tet_volume(bar), 2, 1e-14);
}

TEST(Measures, NormalsOfASpherePointAwayFromItsCenterAtEverySize) {
  for (const double radius : {1e-6, 1.0, 1e6}) {
    const TriangleMesh ball = sphere(3, radius);
    std::vector<Vec3f> positions;
    for (const Vec3d& p : ball.positions) positions.push_back(Vec3f(p));
    std::vector<Vec3f> normals(positions.size());
    vertex_normals<float>(positions, ball.triangles, normals);
    for (std::size_t v = 0; v < normals.size(); ++v) {
      EXPECT_NEAR(length(normals[v]), 1, 1e-6);
      EXPECT_GT(dot(Vec3d(normals[v]), normalized(ball.positions[v])), 0.995);
    }
  }
  TriangleMesh stray = grid(2, 2, 1);
  stray.positions.push_back({5, 5, 5});
  EXPECT_EQ(vertex_normals(stray)[4], Vec3d{});
  EXPECT_EQ(vertex_normals(stray)[0], (Vec3d{0, 1, 0}));
}

}  // namespace souple::test_geometry_measures
