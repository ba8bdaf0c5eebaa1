#include "checks.h"
#include "souple/geometry/builders.h"
#include "souple/geometry/circle.h"
#include "souple/geometry/mass_properties.h"
#include "souple/geometry/measures.h"
#include "tests/expect_error.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <fmt/core.h>
#include <gtest/gtest.h>

namespace souple::test_geometry_mass_properties {

constexpr double density = 700;

// --- polyhedra with closed forms

TriangleMesh tetrahedron() {
  TriangleMesh mesh;
  mesh.positions = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
  mesh.triangles = {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}};
  return mesh;
}

TriangleMesh octahedron() {
  TriangleMesh mesh;
  mesh.positions = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  mesh.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  return mesh;
}

// A prism over a polygon in the XY plane that vertex 0 sees all of.
TriangleMesh extruded(const std::vector<std::array<double, 2>>& outline, double height) {
  const auto n = static_cast<std::uint32_t>(outline.size());
  TriangleMesh mesh;
  for (const double z : {-height / 2, height / 2})
    for (const auto& [x, y] : outline) mesh.positions.push_back({x, y, z});
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t j = (i + 1) % n;
    mesh.triangles.push_back({i, j, n + j});
    mesh.triangles.push_back({i, n + j, n + i});
    if (i == 0 || j == 0) continue;
    mesh.triangles.push_back({0, j, i});
    mesh.triangles.push_back({n, n + i, n + j});
  }
  return mesh;
}

// Corner first: from there the whole L can be seen.
TriangleMesh l_shape() {
  return extruded({{0.2, 0.2}, {0.2, 1}, {0, 1}, {0, 0}, {1, 0}, {1, 0.2}}, 0.3);
}

MassProperties l_shape_in_two_boxes() {
  const MassProperties upright = box_mass_properties({0.2, 1, 0.3}, density);
  const MassProperties foot = box_mass_properties({0.8, 0.2, 0.3}, density);
  const MassProperties parts[] = {moved(upright, {{0.1, 0.5, 0}}), moved(foot, {{0.6, 0.1, 0}})};
  return combined(parts);
}

TriangleMesh merged(const TriangleMesh& a, const TriangleMesh& b, const Vec3d& shift, bool reversed) {
  TriangleMesh mesh = a;
  const auto first = static_cast<std::uint32_t>(a.positions.size());
  for (const Vec3d& p : b.positions) mesh.positions.push_back(p + shift);
  for (Triangle t : b.triangles) {
    if (reversed) std::swap(t[1], t[2]);
    mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  }
  return mesh;
}

MassProperties regular(double volume, double moment_per_mass) {
  const double mass = volume * density;
  return {mass, volume, {}, Mat3d::diagonal(Vec3d{1, 1, 1} * (mass * moment_per_mass))};
}

struct Ring {
  double radius, height;
};

/// A polygon of n sides whose radius r(y) runs linearly from ring to ring. Rings run along the outline, with the
/// outside to the right when looking along +Y. With the area k r^2, k = n/2 sin(2 pi/n), and the polar moment k r^4 (2
/// + cos(2 pi/n)) / 6:
///   V = sum of integrals of k r^2 dy, and so on, by Simpson's rule with enough points to be exact for r^4.
MassProperties revolved(const std::vector<Ring>& outline, int n) {
  const double angle = 2 * pi / n, k = n / 2.0 * std::sin(angle), polar = (2 + std::cos(angle)) / 6;
  double area = 0, moment = 0, square = 0, fourth = 0;
  for (std::size_t i = 0; i + 1 < outline.size(); ++i) {
    const Ring &a = outline[i], &b = outline[i + 1];
    // Gauss's three points: exact up to y^5.
    for (const auto& [at, weight] :
         {std::array{-std::sqrt(0.6), 5.0 / 18}, {0.0, 8.0 / 18}, {std::sqrt(0.6), 5.0 / 18}}) {
      const double s = (1 + at) / 2, r = a.radius + (b.radius - a.radius) * s;
      const double y = a.height + (b.height - a.height) * s, w = weight * (b.height - a.height) * k * r * r;
      area += w;
      moment += w * y;
      square += w * y * y;
      fourth += w * r * r * polar;
    }
  }
  const double center = moment / area, across = fourth / 2 + square - center * moment;
  return {area * density,
          area,
          {0, center, 0},
          Mat3d::diagonal({across * density, fourth * density, across * density})};
}

MassProperties polygon_capsule(double radius, double length, int segments, int rings) {
  std::vector<Ring> outline;
  for (const double side : {-1.0, 1.0})
    for (int i = 0; i <= rings; ++i) {
      const double a = pi / 2 * (side < 0 ? rings - i : i) / rings;
      outline.push_back({radius * std::cos(a), side * (length / 2 + radius * std::sin(a))});
    }
  return revolved(outline, segments);
}

MassProperties polygon_torus(double major, double minor, int segments, int rings) {
  std::vector<Ring> outline;
  for (int j = 0; j <= rings; ++j)
    outline.push_back({major + minor * std::cos(2 * pi * j / rings), minor * std::sin(2 * pi * j / rings)});
  return revolved(outline, segments);
}

MassProperties hollow_box() {
  MassProperties shell = box_mass_properties({2, 2, 2}, density);
  const MassProperties hole = moved(box_mass_properties({1, 0.6, 0.8}, density), {{0.3, 0.1, 0}});
  const double mass = shell.mass - hole.mass;
  const Vec3d center = hole.center * (-hole.mass / mass);
  return {mass, shell.volume - hole.volume, center,
          inertia_about(shell, center) - inertia_about(hole, center)};
}

struct Solid {
  const char* name;
  TriangleMesh mesh;
  MassProperties expected;
};

std::vector<Solid> solids() {
  const double golden = (1 + std::sqrt(5.0)) / 2, s2 = 8,
               edge = 1 / std::sin(2 * pi / 5);  // icosahedron of radius 1
  const TriangleMesh cube = box({2, 2, 2});
  std::vector<Solid> list{
      {"tetrahedron", tetrahedron(), regular(8.0 / 3, s2 / 20)},
      {"cube", cube, regular(8, 4.0 / 6)},
      {"octahedron", octahedron(), regular(4.0 / 3, 2.0 / 10)},
      {"icosahedron", sphere(0, 1),
       regular(5 * (3 + std::sqrt(5.0)) / 12 * edge * edge * edge, golden * golden * edge * edge / 10)},
      {"brick", box({1, 2, 3}, 4), box_mass_properties({1, 2, 3}, density)},
      {"plate", box({1, 0.001, 2}, std::array{5, 1, 9}), box_mass_properties({1, 0.001, 2}, density)},
      {"needle", box({0.001, 1, 0.002}, 3), box_mass_properties({0.001, 1, 0.002}, density)},
      {"beam", box({10, 0.2, 0.1}, std::array{20, 2, 1}), box_mass_properties({10, 0.2, 0.1}, density)},
      {"L", l_shape(), l_shape_in_two_boxes()},
      {"hollow box", merged(cube, box({1, 0.6, 0.8}), {0.3, 0.1, 0}, true), hollow_box()},
      {"triangular prism", cylinder(1, 2, 3), revolved({{1, -1}, {1, 1}}, 3)},
      {"hexagonal prism", cylinder(0.7, 0.1, 6, 1, 3), revolved({{0.7, -0.05}, {0.7, 0.05}}, 6)},
      {"cylinder", cylinder(0.4, 3, 48, 5, 2), revolved({{0.4, -1.5}, {0.4, 1.5}}, 48)},
      {"capsule", capsule(0.5, 2, 32, 8, 4), polygon_capsule(0.5, 2, 32, 8)},
      {"flat capsule", capsule(2, 0.1, 20, 3), polygon_capsule(2, 0.1, 20, 3)},
      {"torus", torus(1, 0.3, 40, 16), polygon_torus(1, 0.3, 40, 16)},
      {"square torus", torus(1, 0.5, 4, 4), polygon_torus(1, 0.5, 4, 4)},
      {"wide ring", torus(5, 0.5, 64, 6), polygon_torus(5, 0.5, 64, 6)},
  };
  const MassProperties two[] = {box_mass_properties({1, 2, 3}, density),
                                moved(regular(4.0 / 3, 0.2), {{5, 0, 1}})};
  list.push_back(
      {"brick and octahedron", merged(box({1, 2, 3}), octahedron(), {5, 0, 1}, false), combined(two)});
  TriangleMesh seam = box({1, 2, 3});  // each triangle with vertices of its own
  for (Triangle& t : seam.triangles)
    for (std::uint32_t& v : t) {
      seam.positions.push_back(seam.positions[v]);
      v = static_cast<std::uint32_t>(seam.positions.size()) - 1;
    }
  list.push_back({"brick with seams", seam, box_mass_properties({1, 2, 3}, density)});
  return list;
}

TriangleMesh placed(TriangleMesh mesh, const Transform& placement) {
  for (Vec3d& p : mesh.positions) p = placement.point(p);
  return mesh;
}

void expect_equal(const MassProperties& found, const MassProperties& expected, double size, double relative) {
  EXPECT_NEAR(found.mass / expected.mass, 1, relative);
  EXPECT_NEAR(found.volume / expected.volume, 1, relative);
  EXPECT_LT(length(found.center - expected.center), relative * size);
  EXPECT_LT(
      std::sqrt(frobenius_squared(found.inertia - expected.inertia) / frobenius_squared(expected.inertia)),
      relative);
}

const Quatd oblique = Quatd::from_euler_xyz({0.3, 1.1, -0.7});

TEST(MassProperties, OfTwentyMeshesMatchTheirClosedForms) {
  const std::vector<Solid> list = solids();
  EXPECT_EQ(list.size(), 20u);
  for (const Solid& solid : list)
    for (const Quatd& turn : {Quatd{}, oblique})
      for (const double scale : {1e-3, 1.0, 1e3})
        for (const double away : {0.0, 1000.0}) {
          SCOPED_TRACE(fmt::format("{}, scale {:g}, {:g} m away", solid.name, scale, away));
          const Transform placement{{away, -0.6 * away, 0.4 * away}, turn, scale};
          const TriangleMesh mesh = placed(solid.mesh, placement);
          const double size = bounding_box(mesh.positions).diagonal();
          // The vertices are rounded where they lie; a plate is a thousandth as thick as it is wide.
          const double rounding = 1e-15 * away / size * 1000;
          expect_equal(mass_properties(mesh, density), moved(solid.expected, placement), size,
                       1e-11 + 10 * rounding);
        }
}

// Counts voxels whose centers are inside: along each row between the crossings of the surface.
MassProperties voxel_integral(const TriangleMesh& mesh, int resolution) {
  const BoundingBox bounds = bounding_box(mesh.positions);
  const Vec3d cell = bounds.size() / double(resolution);
  const double volume = cell.x * cell.y * cell.z;
  MassProperties sum;
  Mat3d second;
  std::vector<double> crossings;
  for (int k = 0; k < resolution; ++k)
    for (int j = 0; j < resolution; ++j) {
      // Not at the middle, so that no row passes through an edge of a symmetric mesh.
      const double y = bounds.lo.y + (j + 0.4871) * cell.y, z = bounds.lo.z + (k + 0.5133) * cell.z;
      crossings.clear();
      for (const auto& [a, b, c] : mesh.triangles) {
        const Vec3d &p = mesh.positions[a], &q = mesh.positions[b], &r = mesh.positions[c];
        const auto side = [&](const Vec3d& u, const Vec3d& v) {
          return (v.y - u.y) * (z - u.z) - (v.z - u.z) * (y - u.y);
        };
        const double wr = side(p, q), wp = side(q, r), wq = side(r, p), all = wp + wq + wr;
        if (!((wp > 0) == (wq > 0) && (wq > 0) == (wr > 0)) || all == 0) continue;
        crossings.push_back((wp * p.x + wq * q.x + wr * r.x) / all);
      }
      std::sort(crossings.begin(), crossings.end());
      for (std::size_t i = 0; i + 1 < crossings.size(); i += 2)
        for (int n = int(std::ceil((crossings[i] - bounds.lo.x) / cell.x - 0.5)); n < resolution; ++n) {
          const Vec3d x{bounds.lo.x + (n + 0.5) * cell.x, y, z};
          if (x.x > crossings[i + 1]) break;
          sum.volume += volume;
          sum.center += x * volume;
          second = second + outer(x, x) * volume;
        }
    }
  sum.center = sum.center / sum.volume;
  second = second - outer(sum.center, sum.center) * sum.volume;
  sum.mass = sum.volume * density;
  sum.inertia = (Mat3d::identity() * trace(second) - second) * density;
  return sum;
}

TEST(MassProperties, OfTwentyMeshesMatchAVoxelIntegral) {
  for (const Solid& solid : solids()) {
    SCOPED_TRACE(solid.name);
    // Thin ones lie along the grid.
    const bool thin = std::min({solid.expected.inertia(0, 0), solid.expected.inertia(1, 1),
                                solid.expected.inertia(2, 2)}) < 0.01 * trace(solid.expected.inertia);
    const TriangleMesh mesh =
        placed(solid.mesh, {{1, 2, 3}, thin ? Quatd{} : Quatd::from_euler_xyz({0.2, 0.1, 0.4}), 1});
    const MassProperties found = mass_properties(mesh, density);
    expect_equal(voxel_integral(mesh, 64), found, bounding_box(mesh.positions).diagonal(), 0.02);
  }
}

// The error of an inscribed polyhedron is one of h^2 + O(h^4): a third of the change from h to h/2 removes the first.
template <class Build>
void expect_limit(const Build& build, const MassProperties& expected) {
  const MassProperties coarse = mass_properties(build(1), density), fine = mass_properties(build(2), density);
  const auto limit = [](double a, double b) { return (4 * b - a) / 3; };
  EXPECT_NEAR(limit(coarse.volume, fine.volume) / expected.volume, 1, 1e-5);
  EXPECT_NEAR(limit(coarse.mass, fine.mass) / expected.mass, 1, 1e-5);
  for (int i = 0; i < 3; ++i)
    EXPECT_NEAR(limit(coarse.inertia(i, i), fine.inertia(i, i)) / expected.inertia(i, i), 1, 1e-5);
  EXPECT_LT(length(fine.center - expected.center), 1e-9);
}

TEST(MassProperties, OfRoundSolidsAreTheLimitOfFinerMeshes) {
  expect_limit([](int n) { return sphere(4 + n, 0.3); }, sphere_mass_properties(0.3, density));
  expect_limit([](int n) { return capsule(0.2, 0.7, 64 * n, 32 * n); },
               capsule_mass_properties(0.2, 0.7, density));
  expect_limit([](int n) { return cylinder(0.2, 0.7, 64 * n); }, cylinder_mass_properties(0.2, 0.7, density));
}

TEST(MassProperties, CombineByTheParallelAxisTheorem) {
  // A brick from eight bricks, far from the origin.
  const Vec3d away{1000, -500, 200};
  std::vector<MassProperties> parts;
  parts.reserve(8);
  for (int i = 0; i < 8; ++i)
    parts.push_back(moved(box_mass_properties({1, 2, 3}, density),
                          {away + Vec3d{(i & 1) - 0.5, (i & 2) - 1.0, 3 * (i >> 2) - 1.5}}));
  expect_equal(combined(parts), moved(box_mass_properties({2, 4, 6}, density), {away}), 7, 1e-12);
  // A rod of mass m and length l about its end: m l^2 / 3.
  const MassProperties rod = with_mass(box_mass_properties({1e-4, 2, 1e-4}, 1), 3);
  EXPECT_NEAR(inertia_about(rod, {0, 1, 0})(0, 0), 3 * 4 / 3.0, 1e-7);
  EXPECT_EQ(rod.mass, 3);
  expect_error([] { combined({}); }, {"no parts"});
  expect_error([&] { combined(std::vector{rod, MassProperties{}}); }, {"part 1", "mass"});
}

Mat3d rebuilt(const PrincipalFrame& frame) {
  const Mat3d r = rotation_matrix(frame.rotation);
  return r * Mat3d::diagonal(frame.moments) * transpose(r);
}

TEST(PrincipalFrame, RebuildsTheTensorOfEveryMesh) {
  for (const Solid& solid : solids())
    for (const Quatd& turn : {Quatd{}, oblique, Quatd::from_euler_xyz({3, -2, 0.5})}) {
      SCOPED_TRACE(solid.name);
      const Mat3d inertia = moved(solid.expected, {{}, turn, 1}).inertia;
      const PrincipalFrame frame = principal_frame(inertia);
      const Mat3d r = rotation_matrix(frame.rotation);
      EXPECT_NEAR(determinant(r), 1, 1e-14);
      EXPECT_LT(frobenius_squared(rebuilt(frame) - inertia), 1e-16 * frobenius_squared(inertia));
      // A quarter turn about an axis brings no frame nearer to the tensor's own: at most 62.8 degrees.
      EXPECT_GE(frame.rotation.w, std::cos(pi * 62.9 / 360));
    }
}

TEST(PrincipalFrame, OfSymmetricBodiesIsNearestToTheirFrame) {
  const auto is_identity = [](const Quatd& q) { return q.x == 0 && q.y == 0 && q.z == 0 && q.w == 1; };
  const PrincipalFrame brick = principal_frame(box_mass_properties({1, 2, 3}, 12).inertia);
  EXPECT_TRUE(is_identity(brick.rotation));
  EXPECT_LT(length(brick.moments - Vec3d{13, 10, 5} * 6.0), 1e-11);
  // Equal moments of a mesh differ by rounding: no axis may depend on that.
  const PrincipalFrame ball =
      principal_frame(mass_properties(placed(sphere(3, 1), {{7, 8, 9}, oblique, 1}), 1).inertia);
  EXPECT_TRUE(is_identity(ball.rotation));
  EXPECT_EQ(ball.moments.x, ball.moments.y);
  EXPECT_EQ(ball.moments.x, ball.moments.z);
  const Quatd lean = Quatd::from_axis_angle({0.6, 0, 0.8}, 0.4);
  const PrincipalFrame can =
      principal_frame(mass_properties(placed(cylinder(1, 3, 24), {{7, 8, 9}, lean, 1}), 1).inertia);
  EXPECT_EQ(can.moments.x, can.moments.z);
  EXPECT_LT(can.moments.y, can.moments.x);
  EXPECT_NEAR(can.rotation.x, lean.x, 1e-9);
  EXPECT_NEAR(can.rotation.y, 0, 1e-9);
  EXPECT_NEAR(can.rotation.z, lean.z, 1e-9);
}

TEST(PrincipalFrame, RefusesWhatNoBodyHas) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  expect_error([] { principal_frame(Mat3d::diagonal({1, 1, 3})); }, {"inertia", "larger than the sum"});
  expect_error([] { require_inertia(Mat3d::diagonal({1, -1, 1}), "crate"); }, {"crate", "positive"});
  expect_error([] { require_inertia({}); }, {"positive"});
  expect_error([&] { require_inertia(Mat3d::diagonal({1, nan, 1})); }, {"not finite"});
  expect_error([] { require_inertia({{1, 0.1, 0}, {0, 1, 0}, {0, 0, 1}}); }, {"not symmetric"});
  require_inertia(Mat3d::diagonal({1, 1, 2}));  // a flat disk
}

TEST(MassProperties, RefuseWhatIsNoSolidInSentences) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const TriangleMesh cube = box({1, 1, 1});
  expect_error([] { mass_properties(grid(4, 4, 1), 1, "sail"); }, {"sail", "closed", "open"});
  expect_error([] { mass_properties({}, 1); }, {"no triangles"});
  TriangleMesh inward = cube;
  for (Triangle& t : inward.triangles) std::swap(t[0], t[1]);
  expect_error([&] { mass_properties(inward, 1, "crate"); }, {"crate", "-1 m^3", "wound inward", "repair"});
  TriangleMesh mixed = cube;
  std::swap(mixed.triangles[3][0], mixed.triangles[3][1]);
  expect_error([&] { mass_properties(mixed, 1); }, {"opposite winding"});
  TriangleMesh folded = grid(3, 3, 1);
  for (std::size_t t = 0; t < 8; ++t) {
    const Triangle back = folded.triangles[t];
    folded.triangles.push_back({back[1], back[0], back[2]});
  }
  folded = placed(folded, {{1, 2, 3}, oblique, 1});
  expect_error([&] { mass_properties(folded, 1); }, {"no volume", "thickness"});
  for (const double wrong : {0.0, -1.0, nan})
    expect_error([&] { mass_properties(cube, wrong, "crate"); }, {"crate", "density", "kg/m^3"});
  TriangleMesh broken = cube;
  broken.triangles[0][0] = 99;
  expect_error([&] { mass_properties(broken, 1); }, {"99"});
  broken = cube;
  broken.positions[2].x = nan;
  expect_error([&] { mass_properties(broken, 1); }, {"not finite"});
  expect_error([] { sphere_mass_properties(0, 1); }, {"sphere", "radius"});
  expect_error([] { box_mass_properties({1, -1, 1}, 1); }, {"box", "size y"});
  expect_error([] { capsule_mass_properties(1, 0, 1); }, {"capsule", "length"});
  expect_error([] { cylinder_mass_properties(1, 1, 0); }, {"cylinder", "density"});
  expect_error([] { with_mass(sphere_mass_properties(1, 1), 0); }, {"mass"});
}

}  // namespace souple::test_geometry_mass_properties
