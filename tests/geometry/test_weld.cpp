#include "checks.h"
#include "souple/error.h"
#include "souple/geometry/builders.h"
#include "souple/geometry/weld.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace souple::test_geometry_weld {

// Each triangle with three vertices of its own, as in an STL file.
TriangleMesh exploded(const TriangleMesh& mesh) {
  TriangleMesh result;
  for (const Triangle& t : mesh.triangles) {
    const std::uint32_t first = std::uint32_t(result.positions.size());
    for (const std::uint32_t v : t) result.positions.push_back(mesh.positions[v]);
    result.triangles.push_back({first, first + 1, first + 2});
  }
  return result;
}

TEST(Weld, ClosesAnExplodedSphere) {
  const TriangleMesh ball = sphere(3, 1), triangle_soup = exploded(ball);
  const Weld weld = weld_vertices(triangle_soup.positions);
  EXPECT_EQ(weld.size(), ball.positions.size());
  const WeldedTriangles welded = weld_triangles(weld, triangle_soup.triangles);
  EXPECT_TRUE(check::is_watertight(welded.triangles));
  for (std::size_t v = 0; v < triangle_soup.positions.size(); ++v)
    EXPECT_EQ(triangle_soup.positions[weld.to_vertex[weld.to_welded[v]]], triangle_soup.positions[v]);
}

TEST(Weld, KeepsTheOrderOfTheUser) {
  const std::vector<Vec3d> p{{5, 0, 0}, {1, 0, 0}, {5, 0, 0}, {0, 0, 0}, {-0.0, 0, 0}, {1, 0, 0}};
  const Weld weld = weld_vertices(p);
  EXPECT_EQ(weld.to_vertex, (std::vector<std::uint32_t>{0, 1, 3}));
  EXPECT_EQ(weld.to_welded, (std::vector<std::uint32_t>{0, 1, 0, 2, 2, 1}));
  const std::vector<int> value{10, 11, 12, 13, 14, 15};
  EXPECT_EQ(gather<int>(weld, value), (std::vector<int>{10, 11, 13}));
  EXPECT_TRUE(weld_vertices(std::vector<Vec3d>{{1, 2, 3}, {3, 2, 1}}).is_identity());
}

TEST(Weld, NoChainCreepsWithATolerance) {
  std::vector<Vec3d> line(10);
  for (std::size_t i = 0; i < line.size(); ++i) line[i].x = 0.6 * static_cast<double>(i);
  const Weld weld = weld_vertices(line, 1.0);
  EXPECT_EQ(weld.to_vertex, (std::vector<std::uint32_t>{0, 2, 4, 6, 8}));
}

TEST(Weld, AgreesWithTheQuadraticDefinition) {
  check::Random random(3);
  std::vector<Vec3d> p;
  for (int i = 0; i < 1500; ++i) {
    const Vec3d x = random.in_cube() + Vec3d{1e6, -1e6, 0};
    p.push_back(x);
    p.push_back(x + random.in_cube() * 0.05);
  }
  const double tolerance = 0.05;
  const Weld weld = weld_vertices(p, tolerance);
  std::vector<std::uint32_t> representatives;
  for (std::uint32_t v = 0; v < p.size(); ++v) {
    std::uint32_t found = v;
    for (const std::uint32_t r : representatives)
      if (length(p[r] - p[v]) <= tolerance) {
        found = r;
        break;
      }
    if (found == v) representatives.push_back(v);
    ASSERT_EQ(weld.to_vertex[weld.to_welded[v]], found);
  }
  EXPECT_LT(weld.size(), p.size());
}

TEST(Weld, RoundingToleranceJoinsRoundedCopiesAndNothingElse) {
  TriangleMesh ball = sphere(3, 100);
  const std::size_t count = ball.positions.size();
  for (std::size_t v = 0; v < count; ++v) ball.positions.push_back(ball.positions[v] + Vec3d{1e-8, 0, -1e-8});
  EXPECT_EQ(weld_vertices(ball.positions).size(), 2 * count);
  EXPECT_EQ(weld_vertices(ball.positions, rounding_tolerance(ball.positions)).size(), count);
}

TEST(Weld, SurvivesWhatIsNotFiniteOrExtreme) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  const std::vector<Vec3d> p{{nan, 0, 0}, {nan, 0, 0}, {inf, 0, 0}, {inf, 0, 0}, {1, 1, 1}, {1, 1, 1}};
  EXPECT_EQ(weld_vertices(p).size(), 5u);
  EXPECT_EQ(weld_vertices(p, 0.1).size(), 5u);
  const std::vector<Vec3d> huge{{1.7e308, 0, 0}, {-1.7e308, 0, 0}, {1.7e308, 0, 0}, {5e-324, 0, 0}};
  EXPECT_EQ(weld_vertices(huge, 1e-9).size(), 3u);
  EXPECT_EQ(weld_vertices({}, 1e-9).size(), 0u);
  EXPECT_THROW(weld_vertices(p, -1), Error);
  EXPECT_THROW(weld_vertices(p, nan), Error);
}

TEST(Weld, DropsTrianglesThatLostAnEdge) {
  const std::vector<Vec3d> p{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 0, 0}};
  const WeldedTriangles welded =
      weld_triangles(weld_vertices(p), std::vector<Triangle>{{0, 1, 3}, {0, 3, 2}});
  EXPECT_EQ(welded.triangles, (std::vector<Triangle>{{0, 1, 2}}));
  EXPECT_EQ(welded.source, (std::vector<std::uint32_t>{1}));
  EXPECT_THROW(weld_triangles(weld_vertices(p), std::vector<Triangle>{{0, 1, 4}}), Error);
}

}  // namespace souple::test_geometry_weld
