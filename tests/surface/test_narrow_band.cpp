#include "souple/collision/mesh_tree.h"
#include "souple/geometry/builders.h"
#include "souple/surface/fluid_surface.h"
#include "souple/surface/narrow_band.h"
#include "tests/expect_error.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <vector>

#include <gtest/gtest.h>

namespace souple::test_surface_narrow_band {

struct Mesh {
  std::vector<Vec3f> positions;
  std::vector<Triangle> triangles;

  void add(const TriangleMesh& other, const Vec3d& offset = {}, bool inside_out = false) {
    const auto first = static_cast<std::uint32_t>(positions.size());
    for (const Vec3d& x : other.positions) positions.emplace_back(x + offset);
    for (Triangle t : other.triangles) {
      if (inside_out) std::swap(t[1], t[2]);
      triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
    }
  }
};

NarrowBand band_of(const Mesh& mesh, float cell, int width = 3, int threads = 2) {
  const auto workers = make_threads(Threading::pool, threads);
  return narrow_band(mesh.positions, mesh.triangles, cell, width, *workers);
}

/// Calls f(position [m], distance, whether in the band) for all points of all bricks.
template <class F>
void for_points(const NarrowBand& band, const F& f) {
  for (const NarrowBand::Brick& brick : band.bricks) {
    for (std::size_t i = 0; i < NarrowBand::brick_points; ++i) {
      const std::size_t x = i / 64, y = i / 8 % 8, z = i % 8;
      const Vec3d in_brick{double(x), double(y), double(z)};
      const Vec3d at = Vec3d(brick.first[0], brick.first[1], brick.first[2]) + in_brick;
      f(at * double(band.cell), double(brick.distances[i]), brick.in_band(i));
    }
  }
}

/// Points in the band, and whether they are inside, by their position in cells.
std::map<std::array<long, 3>, double> values_of(const NarrowBand& band) {
  std::map<std::array<long, 3>, double> values;
  for_points(band, [&](const Vec3d& x, double distance, bool in_band) {
    const Vec3d at = x / double(band.cell);
    if (in_band) values[{std::lround(at.x), std::lround(at.y), std::lround(at.z)}] = distance;
  });
  return values;
}

/// Distance of the middles of an inscribed mesh's triangles from its sphere.
double chord_error(const TriangleMesh& mesh, double radius) {
  double least = radius;
  for (const Triangle& t : mesh.triangles) {
    const Vec3d &a = mesh.positions[t[0]], &b = mesh.positions[t[1]], &c = mesh.positions[t[2]];
    least = std::min(least, dot(normalized(cross(b - a, c - a)), a));
  }
  return radius - least;
}

TEST(NarrowBand, HoldsTheDistanceToASphereOnBothSides) {
  const double radius = 0.5, cell = 0.03125;
  const Vec3d center(0.013, -3.117, 1.041);
  Mesh mesh;
  mesh.add(sphere(4, radius), center);
  const NarrowBand band = band_of(mesh, float(cell));
  EXPECT_FLOAT_EQ(band.width, 3 * float(cell));
  const double sagitta = chord_error(sphere(4, radius), radius), rounding = 1e-6;
  EXPECT_LT(sagitta, 0.05 * cell);
  std::size_t inside = 0, outside = 0;
  for_points(band, [&](const Vec3d& x, double distance, bool in_band) {
    const double expected = length(x - center) - radius;
    if (in_band) {
      EXPECT_GE(distance, expected - rounding);
      EXPECT_LE(distance, expected + sagitta + rounding);
      (distance < 0 ? inside : outside) += 1;
    } else {
      EXPECT_EQ(distance, double(band.width));
    }
  });
  // About as many as the volume of the two shells has.
  const auto shell = [&](double a, double b) {
    return 4 * M_PI / 3 * (b * b * b - a * a * a) / (cell * cell * cell);
  };
  EXPECT_NEAR(double(inside), shell(radius - 3 * cell, radius), 0.02 * shell(radius - 3 * cell, radius));
  EXPECT_NEAR(double(outside), shell(radius, radius + 3 * cell), 0.02 * shell(radius, radius + 3 * cell));
}

// Around a box, faces, edges and corners are nearest in turn. Points on the surface count as outside.
// Triangles are much larger than cells.
TEST(NarrowBand, HoldsTheExactDistanceToABox) {
  const Vec3d half(0.5, 0.25, 0.75);
  Mesh mesh;
  mesh.add(box(half * 2.0));
  std::size_t count = 0;
  for_points(band_of(mesh, 0.0625f), [&](const Vec3d& x, double distance, bool in_band) {
    const Vec3d q(std::abs(x.x) - half.x, std::abs(x.y) - half.y, std::abs(x.z) - half.z);
    const Vec3d beyond(std::max(q.x, 0.0), std::max(q.y, 0.0), std::max(q.z, 0.0));
    const double expected = length(beyond) + std::min(std::max({q.x, q.y, q.z}), 0.0);
    if (std::abs(std::abs(expected) - 3 * 0.0625) > 1e-6) {
      EXPECT_EQ(in_band, std::abs(expected) < 3 * 0.0625) << expected;
    }
    if (!in_band) return;
    EXPECT_NEAR(distance, expected, 1e-6);
    ++count;
  });
  EXPECT_GT(count, 5000u);
}

// At the thin corner of a wedge, whose faces are at 11 degrees, the nearest triangle's normal alone would
// give the wrong side.
TEST(NarrowBand, KnowsTheSidesAtASharpEdge) {
  Mesh mesh;
  const std::vector<Vec3f> x = {{0, 0, 0}, {1, 0.1f, 0}, {1, -0.1f, 0},
                                {0, 0, 1}, {1, 0.1f, 1}, {1, -0.1f, 1}};
  mesh.positions = x;
  mesh.triangles = {{0, 1, 2}, {3, 5, 4}, {0, 3, 4}, {0, 4, 1}, {1, 4, 5}, {1, 5, 2}, {2, 5, 3}, {2, 3, 0}};
  std::size_t inside = 0;
  for_points(band_of(mesh, 0.02f, 4), [&](const Vec3d& p, double distance, bool in_band) {
    if (!in_band || std::abs(distance) < 1e-6) return;
    const bool is_inside = p.x > 0 && p.x < 1 && p.z > 0 && p.z < 1 && std::abs(p.y) < 0.1 * p.x;
    EXPECT_EQ(distance < 0, is_inside) << p.x << " " << p.y << " " << p.z;
    if (is_inside) ++inside;
  });
  EXPECT_GT(inside, 1000u);
}

TEST(NarrowBand, KeepsACavity) {
  Mesh mesh;
  mesh.add(sphere(4, 0.5));
  mesh.add(sphere(3, 0.25), {0.05, 0, 0}, true);
  for_points(band_of(mesh, 0.03125f), [&](const Vec3d& x, double distance, bool in_band) {
    const double outer = length(x) - 0.5, inner = 0.25 - length(x - Vec3d(0.05, 0, 0));
    if (!in_band) return;
    EXPECT_NEAR(distance, std::max(outer, inner), 0.003);
  });
}

// Bands of two balls that are closer than the bands are wide: each point has the distance to the nearer ball.
TEST(NarrowBand, HoldsTwoBallsCloseToEachOther) {
  const Vec3d left(-0.3, 0, 0), right(0.3, 0.02, 0);
  Mesh mesh;
  mesh.add(sphere(4, 0.27), left);
  mesh.add(sphere(4, 0.27), right);
  for_points(band_of(mesh, 0.025f), [&](const Vec3d& x, double distance, bool in_band) {
    const double expected = std::min(length(x - left), length(x - right)) - 0.27;
    if (!in_band) return;
    EXPECT_NEAR(distance, expected, 0.001);
  });
}

// Duplicate points, and triangles that are a line or a point: the same sphere as without them.
TEST(NarrowBand, TrianglesWithoutAreaDoNoHarm) {
  const TriangleMesh ball = sphere(3, 0.5);
  Mesh plain, with;
  plain.add(ball);
  // Each triangle has its own corners; two triangles without area are added at its first edge.
  for (const Triangle& t : ball.triangles) {
    const auto first = static_cast<std::uint32_t>(with.positions.size());
    for (const std::uint32_t v : t) with.positions.emplace_back(ball.positions[v]);
    with.positions.emplace_back(ball.positions[t[0]]);
    with.triangles.push_back({first, first + 1, first + 2});
    with.triangles.push_back({first, first + 1, first + 3});
    with.triangles.push_back({first, first + 3, first + 3});
  }
  with.triangles.push_back({0, 0, 0});
  const auto expected = values_of(band_of(plain, 0.03f));
  EXPECT_EQ(expected, values_of(band_of(with, 0.03f)));
  for (const auto& [at, value] : expected) ASSERT_TRUE(std::isfinite(value));
}

// A triangle with three corners on a line shares its edges with its neighbors.
TEST(NarrowBand, ATriangleThatIsALineDoesNoHarm) {
  Mesh plain, with;
  plain.add(box({0.5, 0.5, 0.5}));
  with = plain;
  const Triangle first = with.triangles[0];
  const Vec3f a = with.positions[first[0]], b = with.positions[first[1]];
  const auto middle = static_cast<std::uint32_t>(with.positions.size());
  with.positions.push_back((a + b) / 2.0f);
  with.triangles[0] = {first[0], middle, first[2]};
  with.triangles.push_back({middle, first[1], first[2]});
  with.triangles.push_back({first[0], first[1], middle});
  const auto expected = values_of(band_of(plain, 0.02f)), found = values_of(band_of(with, 0.02f));
  ASSERT_EQ(expected.size(), found.size());
  for (const auto& [at, value] : expected) ASSERT_NEAR(value, found.at(at), 1e-7);
}

/// A fluid's surface with drops, a hole and a thin sheet: a lattice with noise.
SurfaceMesh splash(float spacing) {
  std::vector<Vec3f> particles;
  std::uint32_t seed = 1;
  const auto noise = [&] {
    seed = seed * 1664525u + 1013904223u;
    return (float(seed >> 8) / float(1 << 24) - 0.5f) * 0.5f;
  };
  for (int i = -9; i <= 9; ++i)
    for (int j = -9; j <= 9; ++j)
      for (int k = -9; k <= 9; ++k) {
        const Vec3f x(float(i) + noise(), float(j) + noise(), float(k) + noise());
        const float r = length(x), drop = noise();
        if ((r < 7 && r > 4) || (r >= 7 && drop > 0.235f) || (j == 8)) particles.push_back(x * spacing);
      }
  FluidSurface surface({.spacing = spacing});
  const auto threads = make_threads(Threading::serial, 1);
  return surface.build(particles, *threads);
}

// An independent reference: the winding number of the surface at a point.
TEST(NarrowBand, SignsOfASplashAreThoseOfTheWindingNumber) {
  const float spacing = 0.02f;
  const SurfaceMesh mesh = splash(spacing);
  const auto threads = make_threads(Threading::pool, 2);
  const NarrowBand band = narrow_band(mesh.positions, mesh.triangles, spacing / 2, 3, *threads);
  std::vector<Vec3d> positions;
  for (const Vec3f& x : mesh.positions) positions.emplace_back(x);
  const MeshTree tree(positions, mesh.triangles);
  std::size_t wrong = 0, inside = 0, count = 0;
  for_points(band, [&](const Vec3d& x, double distance, bool in_band) {
    if (!in_band) return;
    ++count;
    inside += distance < 0 ? 1 : 0;
    EXPECT_NEAR(std::abs(distance), tree.nearest(x).distance, 1e-6 * double(spacing));
    if ((tree.winding_number(x) > 0.5) != (distance < 0) && std::abs(distance) > 1e-4 * double(spacing))
      ++wrong;
  });
  EXPECT_EQ(wrong, 0u) << "of " << count;
  EXPECT_GT(inside, count / 10);
}

// OpenVDB and other readers expect level sets at least three cells wide.
TEST(NarrowBand, IsNeverNarrowerThanItsCells) {
  Mesh mesh;
  mesh.add(sphere(1, 0.05));
  for (const float cell : {0.01f, 0.01105f, 0.0123f, 0.03f, 0.1f, 1 / 3.0f})
    EXPECT_GE(double(band_of(mesh, cell).width), 3 * double(cell));
}

TEST(NarrowBand, IsTheSameForAnyNumberOfThreads) {
  const SurfaceMesh mesh = splash(0.05f);
  Mesh copy{mesh.positions, mesh.triangles};
  const NarrowBand one = band_of(copy, 0.025f, 3, 1);
  for (const int threads : {2, 8}) {
    const NarrowBand many = band_of(copy, 0.025f, 3, threads);
    ASSERT_EQ(one.bricks.size(), many.bricks.size());
    for (std::size_t b = 0; b < one.bricks.size(); ++b) {
      ASSERT_EQ(one.bricks[b].first, many.bricks[b].first);
      ASSERT_EQ(one.bricks[b].band, many.bricks[b].band);
      ASSERT_EQ(one.bricks[b].distances, many.bricks[b].distances);
    }
  }
}

TEST(NarrowBand, OfNothingIsEmptyAndBadInputIsAnError) {
  EXPECT_TRUE(band_of({}, 0.1f).bricks.empty());
  Mesh mesh;
  mesh.add(sphere(1, 1.0));
  expect_error([&] { band_of(mesh, 0); }, {"cell", "above 0"});
  expect_error([&] { band_of(mesh, 0.1f, 0); }, {"width", "1 to 100"});
  expect_error([&] { band_of(mesh, 1e-8f); }, {"vertex 0", "too far", "larger"});
  mesh.positions[7].y = std::numeric_limits<float>::quiet_NaN();
  expect_error([&] { band_of(mesh, 0.1f); }, {"vertex 7", "not finite"});
}

}  // namespace souple::test_surface_narrow_band
