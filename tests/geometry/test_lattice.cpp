#include "checks.h"
#include "souple/error.h"
#include "souple/geometry/adjacency.h"
#include "souple/geometry/builders.h"
#include "souple/geometry/embedding.h"
#include "souple/geometry/lattice.h"
#include "souple/geometry/mesh_report.h"
#include "souple/math/mat3.h"
#include "souple/math/scalar.h"
#include "tests/expect_error.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace souple::test_geometry_lattice {

// Requirements on every lattice: congruent positive tets that match at their faces, in one piece, and cover
// the surface.
void expect_covers(const TriangleMesh& surface, const Lattice& lattice) {
  const double a = lattice.cell_size, tet = a * a * a / 12;
  ASSERT_FALSE(lattice.mesh.tets.empty());
  double sum = 0;
  for (const Tet& t : lattice.mesh.tets) {
    EXPECT_NEAR(check::tet_volume(lattice.mesh, t), tet, 1e-6 * tet);
    sum += check::tet_volume(lattice.mesh, t);
  }
  EXPECT_NEAR(lattice.lattice_volume, sum, 1e-9 * sum);
  EXPECT_GT(sum, check::volume(surface) * (1 - 1e-9));
  EXPECT_EQ(lattice.inner + lattice.crossed, lattice.mesh.tets.size());
  EXPECT_EQ(lattice.pieces, 1u);
  // Points all over the surface, not only its vertices.
  std::vector<Vec3d> points = surface.positions;
  for (const Triangle& t : surface.triangles)
    for (int i = 0; i <= 3; ++i)
      for (int j = 0; i + j <= 3; ++j)
        points.push_back((surface.positions[t[0]] * i + surface.positions[t[1]] * j +
                          surface.positions[t[2]] * (3 - i - j)) /
                         3.0);
  EXPECT_LT(embed(points, lattice.mesh).largest_distance, 1e-7 * a);
  EXPECT_EQ(embed(surface.positions, lattice.mesh).outside, 0u);
}

TEST(Lattice, CoversASphereAtEverySize) {
  for (const double radius : {1e-3, 1.0, 100.0}) {
    const TriangleMesh ball = sphere(3, radius);
    const Lattice lattice = build_lattice(ball, {.cell_size = 0.21 * radius});
    expect_covers(ball, lattice);
    EXPECT_NEAR(lattice.surface_volume, check::volume(ball), 1e-12 * check::volume(ball));
    // No vertex is further outside than a cell.
    for (const Vec3d& p : lattice.mesh.positions) EXPECT_LT(length(p), radius + 1.2 * lattice.cell_size);
    EXPECT_GT(lattice.inner, 0u);
  }
}

TEST(Lattice, CoversATorusAndKeepsItsHole) {
  const TriangleMesh ring = torus(1.0, 0.3, 48, 24);
  const Lattice lattice = build_lattice(ring, {.cell_size = 0.15});
  expect_covers(ring, lattice);
  EXPECT_EQ(check::euler_characteristic(surface_triangles(lattice.mesh.tets)), 0);
  EXPECT_TRUE(check::is_watertight(surface_triangles(lattice.mesh.tets)));
}

TEST(Lattice, VolumeTendsToThatOfTheSolid) {
  const TriangleMesh ball = sphere(4, 1.0);
  double previous = 1e300;
  for (const double size : {0.4, 0.2, 0.1}) {
    const Lattice lattice = build_lattice(ball, {.cell_size = size});
    const double excess = lattice.lattice_volume / lattice.surface_volume - 1;
    EXPECT_GT(excess, 0);
    EXPECT_LT(excess, 0.65 * previous);
    previous = excess;
  }
  EXPECT_LT(previous, 0.2);
}

TEST(Lattice, OfABoxThatLiesInTheLatticePlanes) {
  // Sides of whole and half cells: the surface is on faces, edges and vertices of tets.
  for (const double size : {0.5, 0.25, 0.2, 1.0 / 3, 0.125})
    for (const int divisions : {1, 4}) {
      const TriangleMesh cube = box({1, 1, 1}, divisions);
      const Lattice lattice = build_lattice(cube, {.cell_size = size});
      expect_covers(cube, lattice);
      for (const Vec3d& p : lattice.mesh.positions)
        for (int i = 0; i < 3; ++i) EXPECT_LE(std::abs(p[i]), 0.5 + size * (1 + 1e-9));
    }
}

TEST(Lattice, OfAnOctahedronInTheDiagonalPlanes) {
  // The faces of tets are in planes such as x + y = const: a square prism rotated by 45 degrees is exactly in
  // them.
  TriangleMesh prism = box({std::sqrt(2.0), 1, std::sqrt(2.0)}, 2);
  for (Vec3d& p : prism.positions) p = {(p.x + p.z) / std::sqrt(2.0), p.y, (p.z - p.x) / std::sqrt(2.0)};
  for (Vec3d& p : prism.positions)
    for (int i = 0; i < 3; ++i) p[i] = std::round(p[i] * 4) / 4;
  for (const double size : {0.5, 0.25}) {
    const Lattice lattice = build_lattice(prism, {.cell_size = size});
    expect_covers(prism, lattice);
    EXPECT_NEAR(lattice.surface_volume, 2, 1e-12);
    EXPECT_LT(lattice.lattice_volume, 2 * (1 + 3 * size));
  }
}

TEST(Lattice, ThinPartsAreCovered) {
  const TriangleMesh plate = box({1, 0.001, 1}, {8, 1, 8});
  expect_covers(plate, build_lattice(plate, {.cell_size = 0.1}));
  const TriangleMesh needle = cylinder(0.002, 1, 8, 10);
  expect_covers(needle, build_lattice(needle, {.cell_size = 0.07}));
}

TEST(Lattice, MeetsATargetCount) {
  for (const std::size_t target : {500u, 2000u, 20000u}) {
    const TriangleMesh ring = torus(1.0, 0.3, 64, 32), ball = sphere(3, 0.05);
    EXPECT_NEAR(double(build_lattice(ring, {.cells = target}).mesh.tets.size()) / double(target), 1, 0.15);
    EXPECT_NEAR(double(build_lattice(ball, {.cells = target}).mesh.tets.size()) / double(target), 1, 0.15);
  }
  EXPECT_GT(build_lattice(sphere(1, 1), {.cells = 1}).mesh.tets.size(), 0u);
}

// The count of a wire falls with the size, not with its square: the search must tell, or it ends far off.
TEST(Lattice, MeetsATargetCountForAWire) {
  const TriangleMesh ring = torus(0.3, 1e-6, 8, 5);
  const Lattice lattice = build_lattice(ring, {.cells = 2000});
  EXPECT_NEAR(double(lattice.mesh.tets.size()) / 2000, 1, 0.05);
  expect_covers(ring, lattice);
}

// Two surfaces in one mesh.
TriangleMesh joined(TriangleMesh a, const TriangleMesh& b, const Vec3d& shift) {
  const std::uint32_t first = std::uint32_t(a.positions.size());
  for (const Vec3d& p : b.positions) a.positions.push_back(p + shift);
  for (const Triangle& t : b.triangles) a.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  return a;
}

TEST(Lattice, CavityStaysHollowIfWoundInwardAndFillsIfNot) {
  TriangleMesh inner = sphere(3, 0.6);
  const TriangleMesh solid = joined(sphere(3, 1.0), inner, {});
  for (Triangle& t : inner.triangles) std::swap(t[1], t[2]);
  const TriangleMesh hollow = joined(sphere(3, 1.0), inner, {});
  const Lattice full = build_lattice(solid, {.cell_size = 0.12});
  const Lattice shell = build_lattice(hollow, {.cell_size = 0.12});
  EXPECT_GT(full.lattice_volume, 4.0 / 3 * pi * 0.98);
  EXPECT_LT(shell.lattice_volume, full.lattice_volume - 4.0 / 3 * pi * 0.3 * 0.3 * 0.3);
  EXPECT_EQ(check::euler_characteristic(surface_triangles(shell.mesh.tets)), 4);  // two spheres
}

TEST(Lattice, SeparateBodiesStaySeparate) {
  const TriangleMesh pair = joined(sphere(2, 0.5), sphere(2, 0.5), {2, 0, 0});
  EXPECT_EQ(build_lattice(pair, {.cell_size = 0.2}).pieces, 2u);
}

TEST(Lattice, AcceptsTriangleSoupAndWrongWinding) {
  const TriangleMesh ball = sphere(3, 1);
  TriangleMesh triangle_soup;
  for (std::size_t t = 0; t < ball.triangles.size(); ++t) {
    const std::uint32_t first = std::uint32_t(triangle_soup.positions.size());
    for (const std::uint32_t v : ball.triangles[t]) triangle_soup.positions.push_back(ball.positions[v]);
    triangle_soup.triangles.push_back(
        {first, first + (t % 3 == 0 ? 2u : 1u), first + (t % 3 == 0 ? 1u : 2u)});
  }
  const Lattice a = build_lattice(ball, {.cell_size = 0.25}),
                b = build_lattice(triangle_soup, {.cell_size = 0.25});
  EXPECT_EQ(a.mesh.positions, b.mesh.positions);
  EXPECT_EQ(a.mesh.tets, b.mesh.tets);
  EXPECT_EQ(embed(triangle_soup.positions, b.mesh).outside, 0u);
}

std::string message_of(const TriangleMesh& mesh, const LatticeOptions& options) {
  return error_of([&] { build_lattice(mesh, options, "duck.obj"); });
}

TEST(Lattice, RefusesWithClearWords) {
  expect_words(message_of(grid(4, 4, 1), {.cell_size = 0.1}),
               {"duck.obj: a closed surface is needed here, but 12 edges are open"});
  const TriangleMesh ball = sphere(2, 1);
  expect_words(message_of(ball, {.cell_size = 1e-6}), {"more than 4 million"});
  expect_words(message_of(ball, {}), {"neither"});
  expect_words(message_of(ball, {.cell_size = 0.1, .cells = 5}), {"both"});
  expect_words(message_of(ball, {.cell_size = -1}), {"positive"});
  expect_words(message_of(ball, {.cells = 20000000}), {"expected 1"});
  TriangleMesh flat = box({1, 1, 1}, 3);
  for (Vec3d& p : flat.positions) p.y = p.x;
  EXPECT_NE(message_of(flat, {.cell_size = 0.1}), "");
  expect_words(message_of(TriangleMesh{}, {.cell_size = 0.1}), {"no triangles"});
}

// Closed surfaces that intersect themselves, with needles, slivers and duplicates, sometimes of extreme size.
TEST(Lattice, OfRandomSurfacesCoversThemOrSaysWhyNot) {
  check::Random random(11);
  int built = 0;
  for (int round = 0; round < 300; ++round) {
    TriangleMesh mesh = round % 2 == 0 ? sphere(int(round % 3), 1) : box({1, 1, 1}, 1 + round % 4);
    const double noise = random.unit(), scale = round % 10 == 9 ? 1e160 : 1;
    for (Vec3d& p : mesh.positions) {
      p = (p + random.vector() * noise) * scale;
      // Snapped to a coarse raster, so that vertices coincide and triangles collapse or lie in the lattice's
      // planes.
      if (round % 4 >= 2)
        for (int i = 0; i < 3; ++i) p[i] = std::round(p[i] * 4) / 4;
    }
    try {
      const Lattice lattice = build_lattice(mesh, {.cell_size = 0.25 * scale});
      ++built;
      const RepairedSurface surface = repair(mesh);
      std::vector<Vec3d> points;
      for (const Triangle& t : surface.triangles)
        for (const std::uint32_t v : t) points.push_back(mesh.positions[surface.weld.to_vertex[v]]);
      ASSERT_EQ(embed(points, lattice.mesh).outside, 0u) << "round " << round;
      for (const Tet& t : lattice.mesh.tets) ASSERT_GT(check::tet_volume(lattice.mesh, t), 0);
    } catch (const Error& error) {
      EXPECT_EQ(std::string(error.what()).find("mesh: "), 0u) << error.what();
    }
  }
  EXPECT_GT(built, 200);
}

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
  for (int i = 0; i < 2000; ++i) points.push_back(random.vector());
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
  for (int i = 0; i < 300; ++i) points.push_back(random.vector() * 2.0);
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

}  // namespace souple::test_geometry_lattice
