#include "checks.h"
#include "souple/geometry/builders.h"
#include "souple/geometry/circle.h"
#include "souple/geometry/convex_hull.h"
#include "souple/geometry/measures.h"
#include "souple/math/transform.h"
#include "tests/expect_error.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

namespace souple::test_geometry_convex_hull {

using Points = std::vector<Vec3d>;

double volume(const ConvexHull& hull) {
  const TriangleMesh mesh = surface_mesh(hull);
  return enclosed_volume(mesh.positions, mesh.triangles);
}

double beyond(const HullFace& face, const Vec3d& p) {
  return dot(face.normal, p) - face.offset;
}

// Each edge has a corner in two faces.
std::size_t edge_count(const ConvexHull& hull) {
  return hull.corners.size() / 2;
}

// Each edge joins two faces, each face knows its edges, and V - E + F = 2.
void expect_surface(const ConvexHull& hull) {
  const TriangleMesh mesh = surface_mesh(hull);
  EXPECT_TRUE(check::is_watertight(mesh.triangles));
  EXPECT_EQ(check::euler_characteristic(mesh.triangles), 2);
  EXPECT_EQ(hull.positions.size() + hull.faces.size(), edge_count(hull) + 2);
  for (const HullFace& face : hull.faces) ASSERT_GE(face.count, 3u);
}

// Faces are flat and convex, with the whole hull behind them and no point of the input beyond the excess.
void expect_convex(const ConvexHull& hull, const Points& points, double tolerance) {
  const double rounding = 1e-11 * bounding_box(points).diagonal() + 1e-15 * length(points[0]);
  for (const HullFace& face : hull.faces) {
    EXPECT_NEAR(length(face.normal), 1, 1e-14);
    for (const Vec3d& p : hull.positions) ASSERT_LE(beyond(face, p), rounding);
    for (const Vec3d& p : points) ASSERT_LE(beyond(face, p), hull.excess + tolerance + rounding);
    const auto loop = hull.loop(face);
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const Vec3d &u = hull.positions[loop[i]], &v = hull.positions[loop[(i + 1) % loop.size()]],
                  &w = hull.positions[loop[(i + 2) % loop.size()]];
      ASSERT_GE(beyond(face, v), -3 * tolerance - rounding);
      ASSERT_GE(dot(face.normal, cross(v - u, w - v)),
                -(tolerance + rounding) * std::max({length(v - u), length(w - v), length(w - u)}));
    }
  }
}

ConvexHull checked_hull(const Points& points, const HullOptions& options = {}) {
  ConvexHull hull = convex_hull(points, options);
  const double tolerance = options.tolerance * bounding_box(points).diagonal();
  expect_surface(hull);
  expect_convex(hull, points, tolerance);
  for (std::size_t v = 0; v < hull.positions.size(); ++v) {
    EXPECT_EQ(hull.positions[v], points[hull.source[v]]);
    if (v > 0) {
      EXPECT_LT(hull.source[v - 1], hull.source[v]);
    }
  }
  if (options.max_vertices == 0) {
    EXPECT_LE(hull.excess, 1.5 * tolerance + 1e-11 * bounding_box(points).diagonal());
  } else {
    EXPECT_LE(hull.positions.size(), options.max_vertices);
  }
  return hull;
}

Points placed(Points points, const Transform& placement) {
  for (Vec3d& p : points) p = placement.point(p);
  return points;
}

Points in_floats(Points points) {
  for (Vec3d& p : points) p = Vec3d(Vec3f(p));
  return points;
}

const Quatd oblique = Quatd::from_euler_xyz({0.3, 1.1, -0.7});

Points cube_corners() {
  return box({2, 2, 2}).positions;
}

Points cube_filled(std::size_t count) {
  check::Random random(7);
  Points points;
  for (std::size_t i = 0; i < count; ++i) points.push_back(random.vector() * 0.999);
  const Points corners = cube_corners();
  points.insert(points.end(), corners.begin(), corners.end());
  return points;
}

Points prism(int sides, double radius, double height) {
  Points points;
  for (int k = 0; k < sides; ++k) {
    const CirclePoint p = circle_point(k, sides);
    points.push_back({radius * p.cosine, -height / 2, radius * p.sine});
    points.push_back({radius * p.cosine, height / 2, radius * p.sine});
  }
  return points;
}

Points on_sphere(std::size_t count, std::uint64_t seed) {
  check::Random random(seed);
  Points points;
  while (points.size() < count) {
    const Vec3d p = random.vector();
    if (length(p) < 1 && length(p) > 0.1) points.push_back(normalized(p));
  }
  return points;
}

std::size_t faces_with(const ConvexHull& hull, std::size_t corners) {
  std::size_t count = 0;
  for (const HullFace& face : hull.faces) count += face.count == corners;
  return count;
}

TEST(ConvexHull, OfAFilledCubeIsSixQuads) {
  const Points cube = cube_filled(1000);
  for (const Transform& placement : {Transform{}, Transform{{1000, -2000, 500}, oblique, 0.01},
                                     Transform{{1e6, 0, 0}, oblique, 300}, Transform{{}, {}, 1e-6}}) {
    const ConvexHull hull = checked_hull(placed(cube, placement));
    EXPECT_EQ(hull.positions.size(), 8u);
    EXPECT_EQ(edge_count(hull), 12u);
    EXPECT_EQ(faces_with(hull, 4), 6u);
    const double side = 2 * placement.scale;
    EXPECT_NEAR(volume(hull) / (side * side * side), 1, 1e-9);
  }
}

TEST(ConvexHull, OfCoordinatesInFloatsHasTheFacesOfTheShape) {
  for (const double angle : {0.1, 0.2, 0.5, 0.9, 1.3}) {
    const Transform placement{{1, 2, -1.5}, Quatd::from_euler_xyz({angle, 2 * angle, -angle}), 0.7};
    const ConvexHull cube = checked_hull(in_floats(placed(box({2, 2, 2}, 12).positions, placement)));
    EXPECT_EQ(faces_with(cube, 4), 6u);
    EXPECT_EQ(cube.faces.size(), 6u);
    const ConvexHull can = checked_hull(in_floats(placed(cylinder(1, 3, 32, 9, 5).positions, placement)));
    EXPECT_EQ(faces_with(can, 32), 2u);
    EXPECT_EQ(faces_with(can, 4), 32u);
  }
}

TEST(ConvexHull, OfALatticeHasOnlyItsCorners) {
  Points points;
  for (int i = 0; i <= 10; ++i)
    for (int j = 0; j <= 12; ++j)
      for (int k = 0; k <= 7; ++k) points.push_back(Vec3d{double(i), double(j), double(k)} * 0.1);
  for (const Quatd& turn : {Quatd{}, oblique}) {
    const ConvexHull hull = checked_hull(placed(points, {{}, turn, 1}));
    EXPECT_EQ(hull.positions.size(), 8u);
    EXPECT_EQ(faces_with(hull, 4), 6u);
    EXPECT_NEAR(volume(hull), 0.84, 1e-10);
  }
}

TEST(ConvexHull, OfAPrismHasTwoCapsAndQuads) {
  for (const int sides : {3, 5, 8, 64, 1000}) {
    const double area = sides / 2.0 * std::sin(2 * pi / sides);
    for (const Quatd& turn : {Quatd{}, oblique}) {
      const ConvexHull hull = checked_hull(placed(prism(sides, 1, 0.5), {{3, 0, 0}, turn, 1}));
      const auto n = std::size_t(sides);
      EXPECT_EQ(hull.faces.size(), n + 2);
      EXPECT_EQ(faces_with(hull, 4), n);
      EXPECT_EQ(faces_with(hull, n), 2u);
      EXPECT_NEAR(volume(hull), area / 2, 1e-9);
    }
  }
}

TEST(ConvexHull, OfThePlatonicSolids) {
  const double f = (1 + std::sqrt(5.0)) / 2, g = 1 / f;
  Points dodecahedron;
  for (const double a : {-1.0, 1.0})
    for (const double b : {-1.0, 1.0}) {
      for (const Vec3d& p : {Vec3d{0, a * g, b * f}, Vec3d{a * g, b * f, 0}, Vec3d{a * f, 0, b * g}})
        dodecahedron.push_back(p);
      for (const double c : {-1.0, 1.0}) dodecahedron.push_back({a, b, c});
    }
  const double edge = 2 * g;
  for (const Quatd& turn : {Quatd{}, oblique}) {
    const ConvexHull twelve = checked_hull(placed(dodecahedron, {{}, turn, 1}));
    EXPECT_EQ(twelve.faces.size(), 12u);
    EXPECT_EQ(faces_with(twelve, 5), 12u);
    EXPECT_NEAR(volume(twelve), (15 + 7 * std::sqrt(5.0)) / 4 * edge * edge * edge, 1e-9);
    const ConvexHull eight = checked_hull(
        placed({{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}}, {{}, turn, 1}));
    EXPECT_EQ(faces_with(eight, 3), 8u);
    EXPECT_NEAR(volume(eight), 4.0 / 3, 1e-10);
    EXPECT_EQ(checked_hull(placed(sphere(0, 1).positions, {{}, turn, 1})).faces.size(), 20u);
    const Points tet{{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
    EXPECT_EQ(edge_count(checked_hull(placed(tet, {{}, turn, 1}))), 6u);
  }
}

TEST(ConvexHull, OfASphereHasAllItsVertices) {
  const TriangleMesh ball = sphere(4, 0.3);
  const ConvexHull hull = checked_hull(ball.positions);
  EXPECT_EQ(hull.positions.size(), ball.positions.size());
  EXPECT_GE(volume(hull), enclosed_volume(ball.positions, ball.triangles) * (1 - 1e-12));
  EXPECT_LT(volume(hull), 4.0 / 3 * pi * 0.027);
  EXPECT_EQ(checked_hull(on_sphere(1000, 3)).positions.size(), 1000u);
}

// A plane through three points with all others on one side, by trying all. Coordinates are small integers: exact.
struct Facet {
  long x, y, z, d;
  friend bool operator<(const Facet& a, const Facet& b) {
    return std::tie(a.x, a.y, a.z, a.d) < std::tie(b.x, b.y, b.z, b.d);
  }
};

Facet reduced(const Vec3<long>& n, const Vec3<long>& p) {
  const long d = dot(n, p), common = std::gcd(std::gcd(n.x, n.y), n.z);
  return {n.x / common, n.y / common, n.z / common, d / common};
}

std::set<Facet> brute_force_facets(const std::vector<Vec3<long>>& points) {
  std::set<Facet> facets;
  for (std::size_t i = 0; i < points.size(); ++i)
    for (std::size_t j = i + 1; j < points.size(); ++j)
      for (std::size_t k = j + 1; k < points.size(); ++k) {
        const Vec3<long> n = cross(points[j] - points[i], points[k] - points[i]);
        if (n == Vec3<long>{}) continue;
        bool above = false, below = false;
        for (const Vec3<long>& p : points) {
          const long side = dot(n, p - points[i]);
          above = above || side > 0;
          below = below || side < 0;
        }
        if (!above) facets.insert(reduced(n, points[i]));
        if (!below) facets.insert(reduced(-n, points[i]));
      }
  return facets;
}

// Whether the normals of the facets through a point span space, so that it is a corner.
bool is_corner(const Vec3<long>& p, const std::set<Facet>& facets) {
  std::vector<Vec3<long>> normals;
  for (const Facet& f : facets)
    if (dot(Vec3<long>{f.x, f.y, f.z}, p) == f.d) normals.push_back({f.x, f.y, f.z});
  for (const Vec3<long>& a : normals)
    for (const Vec3<long>& b : normals)
      for (const Vec3<long>& c : normals)
        if (dot(a, cross(b, c)) != 0) return true;
  return false;
}

TEST(ConvexHull, IsThatOfABruteForceSearch) {
  check::Random random(11);
  int compared = 0;
  for (int round = 0; round < 150; ++round) {
    const long side = round % 3 == 0 ? 2 : (round % 3 == 1 ? 5 : 1000);
    std::vector<Vec3<long>> integers;
    Points points;
    for (int i = 0; i < 5 + round % 20; ++i) {
      const auto next = [&] { return long(random.bits() % std::uint64_t(side + 1)); };
      const long x = next(), y = next(), z = next();
      integers.push_back({x, y, z});
      points.push_back(Vec3d(integers.back()));
    }
    const std::set<Facet> facets = brute_force_facets(integers);
    if (facets.size() < 4) continue;  // flat
    ++compared;
    const ConvexHull hull = checked_hull(points);
    std::set<Facet> found;
    for (const HullFace& face : hull.faces) {
      const auto loop = hull.loop(face);
      const Vec3<long>&a = integers[hull.source[loop[0]]], &b = integers[hull.source[loop[1]]],
            &c = integers[hull.source[loop[2]]];
      found.insert(reduced(cross(b - a, c - a), a));
    }
    EXPECT_EQ(found.size(), hull.faces.size());
    EXPECT_TRUE(std::equal(found.begin(), found.end(), facets.begin(), facets.end(),
                           [](const Facet& a, const Facet& b) { return !(a < b) && !(b < a); }));
    std::set<std::array<long, 3>> corners, vertices;
    for (const Vec3<long>& p : integers)
      if (is_corner(p, facets)) corners.insert({p.x, p.y, p.z});
    for (const std::uint32_t s : hull.source) vertices.insert({integers[s].x, integers[s].y, integers[s].z});
    EXPECT_EQ(vertices, corners);
    EXPECT_EQ(vertices.size(), hull.positions.size());
  }
  EXPECT_GT(compared, 120);
}

TEST(ConvexHull, DuplicatesAndPointsOnEdgesChangeNothing) {
  Points points = cube_corners();
  for (int copies = 0; copies < 5; ++copies) {
    const Points corners = cube_corners();
    points.insert(points.end(), corners.begin(), corners.end());
  }
  for (int i = 1; i < 10; ++i) points.push_back({1, 1, -1 + 0.2 * i});
  for (const Quatd& turn : {Quatd{}, oblique}) {
    const ConvexHull hull = checked_hull(placed(points, {{0, 5, 0}, turn, 1}));
    EXPECT_EQ(faces_with(hull, 4), 6u);
    EXPECT_EQ(hull.positions.size(), 8u);
  }
}

// Integer combinations of three integer vectors are exactly coplanar, but rounded products say they are not.
TEST(ConvexHull, OfAnObliqueLatticeIsAParallelepiped) {
  check::Random random(1);
  const auto integer = [&] { return std::floor(random.unit() * std::ldexp(1.0, 36)); };
  const auto vector = [&] {
    const double x = integer(), y = integer(), z = integer();
    return Vec3d{x, y, z} * std::ldexp(1.0, -10);
  };
  for (int round = 0; round < 500; ++round) {
    const Vec3d u = vector(), v = vector(), w = vector();
    if (std::abs(dot(u, cross(v, w))) < 0.01 * length(u) * length(v) * length(w)) continue;
    Points points;
    for (int a = 0; a <= 3; ++a)
      for (int b = 0; b <= 3; ++b)
        for (int c = 0; c <= 3; ++c) points.push_back(u * double(a) + v * double(b) + w * double(c));
    const ConvexHull hull = checked_hull(points, {0, 0});
    EXPECT_EQ(hull.positions.size(), 8u);
    EXPECT_EQ(faces_with(hull, 4), 6u);
    EXPECT_EQ(hull.excess, 0);
  }
}

// Points of a lattice or of an ellipsoid, of any thickness and size, moved by a little: nearly flat faces, clusters, needles
// and plates.
Points nearly_degenerate(check::Random& random, int count, bool round) {
  const Vec3d size{std::pow(10, -4 * random.unit()), std::pow(10, -4 * random.unit()), 1};
  const double noise = std::pow(10, -3 - 13 * random.unit());
  const std::uint64_t cells = 1 + random.bits() % 5;
  Points points;
  for (int i = 0; i < count; ++i) {
    Vec3d p = normalized(random.vector());
    for (int axis = 0; axis < 3; ++axis) {
      const double on_lattice = double(random.bits() % (cells + 1)) / double(cells);
      p[axis] = size[axis] * (round ? p[axis] : on_lattice);
    }
    points.push_back(p + random.vector() * noise);
  }
  const Vec3d away = random.vector() * 100.0;
  return placed(points,
                {away, Quatd::from_euler_xyz(random.vector() * 3.0), std::pow(10, 6 * random.unit() - 3)});
}

// With tolerances from none to coarse.
TEST(ConvexHull, IsClosedAndConvexForNearlyDegeneratePoints) {
  check::Random random(5);
  int hulls = 0;
  for (int round = 0; round < 3000; ++round) {
    const Points points = nearly_degenerate(random, 20 + round % 80, round % 5 == 0);
    const double tolerance = round % 4 == 0 ? 0 : std::pow(10, -2 - 8 * random.unit());
    SCOPED_TRACE(round);
    try {
      checked_hull(points, {tolerance, 0});
      ++hulls;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find("enclose no volume"), std::string::npos) << error.what();
    }
    if (HasFailure()) return;
  }
  EXPECT_GT(hulls, 2000);
}

TEST(ConvexHull, OfAThinPlateAndANeedle) {
  for (const Quatd& turn : {Quatd{}, oblique}) {
    const ConvexHull plate = checked_hull(placed(box({1, 1e-4, 1}, 8).positions, {{1, 1, 1}, turn, 1}));
    EXPECT_EQ(faces_with(plate, 4), 6u);
    EXPECT_NEAR(volume(plate), 1e-4, 1e-10);
    const ConvexHull needle = checked_hull(placed(box({1e-4, 1, 2e-4}).positions, {{1, 1, 1}, turn, 1}));
    EXPECT_EQ(faces_with(needle, 4), 6u);
    EXPECT_NEAR(volume(needle), 2e-8, 1e-13);
  }
}

TEST(ConvexHull, WithFewVerticesLiesInsideByTheStatedExcess) {
  Points points = on_sphere(2000, 2);
  for (Vec3d& p : points) p = {3 * p.x, p.y, 0.5 * p.z};
  const ConvexHull full = checked_hull(points);
  double last = 10;
  for (const std::size_t limit : {4u, 8u, 16u, 64u, 256u}) {
    const ConvexHull hull = checked_hull(points, {1e-6, limit});
    EXPECT_EQ(hull.positions.size(), limit);
    double excess = 0;
    for (const HullFace& face : hull.faces)
      for (const Vec3d& p : points) excess = std::max(excess, beyond(face, p));
    EXPECT_NEAR(hull.excess, excess, 1e-9);
    EXPECT_LT(hull.excess, last);
    EXPECT_LT(volume(hull), volume(full));
    last = hull.excess;
  }
  EXPECT_LT(last, 0.05);
  EXPECT_GT(volume(checked_hull(points, {1e-6, 64})), 0.85 * volume(full));
  EXPECT_EQ(faces_with(checked_hull(cube_filled(1000), {1e-6, 8}), 4), 6u);
}

TEST(ConvexHull, IsTheSameInEveryRun) {
  const Points points = placed(on_sphere(3000, 9), {{1, 2, 3}, oblique, 2});
  const ConvexHull a = convex_hull(points), b = convex_hull(points);
  EXPECT_EQ(a.source, b.source);
  EXPECT_EQ(a.corners, b.corners);
  EXPECT_EQ(a.excess, b.excess);
  ASSERT_EQ(a.faces.size(), b.faces.size());
  for (std::size_t f = 0; f < a.faces.size(); ++f) {
    EXPECT_EQ(a.faces[f].normal, b.faces[f].normal);
    EXPECT_EQ(a.faces[f].offset, b.faces[f].offset);
  }
}

TEST(ConvexHull, OfAHundredThousandPoints) {
  Points ball;
  check::Random random(4);
  while (ball.size() < 100000) {
    const Vec3d p = random.vector();
    if (length(p) < 1) ball.push_back(p);
  }
  const ConvexHull hull = convex_hull(ball);
  expect_surface(hull);
  EXPECT_GT(volume(hull), 0.98 * 4.0 / 3 * pi);
  EXPECT_LT(volume(hull), 4.0 / 3 * pi);
  const ConvexHull round = convex_hull(on_sphere(100000, 6));
  EXPECT_EQ(round.positions.size() + round.faces.size(), edge_count(round) + 2);
  EXPECT_GT(round.positions.size(), 90000u);
  EXPECT_NEAR(volume(round), 4.0 / 3 * pi, 1e-3);
}

TEST(ConvexHull, MeshHasThePolygonsAsFaces) {
  const TriangleMesh cube = surface_mesh(convex_hull(cube_corners()));
  EXPECT_EQ(cube.faces.size(), 6u);
  EXPECT_EQ(cube.triangles.size(), 12u);
  check_indices(cube);
  EXPECT_TRUE(surface_mesh(convex_hull(sphere(0, 1).positions)).faces.empty());
}

TEST(ConvexHull, RefusesPointsWithoutVolumeInSentences) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  expect_error([] { convex_hull({}); }, {"convex hull", "0 points", "at least 4"});
  const auto refused = [](const Points& points, std::initializer_list<std::string> words) {
    expect_error([&] { convex_hull(points, {}, "crate"); }, words);
  };
  refused({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {"crate", "3 points"});
  refused({{0, 0, 0}, {1, 0, 0}, {0, nan, 0}, {0, 0, 1}}, {"point 2", "finite"});
  refused({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1e300}}, {"point 3", "1e9"});
  refused(Points(10, Vec3d{1, 2, 3}), {"coincide", "thickness"});
  refused({{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {5, 5, 5}}, {"on a line"});
  refused(placed(grid(20, 20, 1).positions, {{3, 2, 1}, oblique, 1}), {"in a plane"});
  refused(box({1, 1e-7, 1}).positions, {"in a plane", "tolerance"});
  EXPECT_EQ(convex_hull(box({1, 1e-7, 1}).positions, {1e-9, 0}).faces.size(), 6u);
  expect_error([] { convex_hull(cube_corners(), {-1, 0}); }, {"tolerance is -1", "0 to 0.1"});
  expect_error([&] { convex_hull(cube_corners(), {nan, 0}); }, {"tolerance"});
  expect_error([] { convex_hull(cube_corners(), {1e-6, 3}); }, {"max_vertices is 3", "at least 4"});
}

}  // namespace souple::test_geometry_convex_hull
