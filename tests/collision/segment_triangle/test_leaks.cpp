#include "souple/geometry/builders.h"
#include "tests/collision/random.h"
#include "tests/collision/segment_triangle/every_test.h"

#include <limits>
#include <vector>

// No ray from inside leaves a closed mesh without a crossing, also when aimed at its edges and corners.

namespace souple::test::test_segment_triangle_leaks {

template <class T>
struct Surface {
  std::vector<Vec3<T>> positions;
  std::vector<Triangle> triangles;

  Corners<T> corners(const Triangle& triangle) const {
    return {positions[triangle[0]], positions[triangle[1]], positions[triangle[2]]};
  }
};

/// A mesh rotated so that no axis is special, stretched and moved; corners are rounded once.
template <class T>
Surface<T> placed(const TriangleMesh& mesh, const Vec3d& stretch, const Vec3d& where) {
  Surface<T> surface;
  surface.triangles.assign(mesh.triangles.begin(), mesh.triangles.end());
  for (const Vec3d& v : mesh.positions) {
    const Vec3d s{v.x * stretch.x, v.y * stretch.y, v.z * stretch.z};
    const Vec3d turned{0.36 * s.x + 0.48 * s.y - 0.8 * s.z, -0.8 * s.x + 0.6 * s.y,
                       0.48 * s.x + 0.64 * s.y + 0.6 * s.z};
    surface.positions.emplace_back(turned + where);
  }
  return surface;
}

template <class T>
Segment<T> ray_to(const Vec3<T>& from, const Vec3<T>& to) {
  return {from, to - from, std::numeric_limits<T>::infinity()};
}

template <class Test, class T>
bool leaks(const Surface<T>& surface, const Segment<T>& ray) {
  return Test::template prepare<T>(ray, [&](const auto& crosses_ray) {
    for (const Triangle& triangle : surface.triangles)
      if (crosses(crosses_ray(surface.corners(triangle)))) return false;
    return true;
  });
}

/// Number of rays that leave without a crossing: from a few points inside to every corner, to points of every
/// edge and to random points.
template <class Test, class T>
int count_leaks(const Surface<T>& surface, const std::vector<Vec3<T>>& within, int& rays) {
  Random random(21);
  int out = 0;
  const auto shoot = [&](const Vec3<T>& from, const Vec3<T>& to) {
    ++rays;
    out += leaks<Test>(surface, ray_to(from, to));
  };
  for (const Vec3<T>& from : within) {
    for (const Vec3<T>& corner : surface.positions) shoot(from, corner);
    for (const Triangle& triangle : surface.triangles) {
      const auto [a, b, c] = surface.corners(triangle);
      shoot(from, (a + b) * T(0.5));
      const T part = static_cast<T>(random.uniform(0, 1));
      shoot(from, b * part + c * (1 - part));
      shoot(from, from + Vec3<T>(random.point(-1, 1)));
    }
  }
  return out;
}

/// Number of leaks of all meshes.
template <class Test, class T>
int count_all_leaks(int& rays) {
  int out = 0;
  for (const double far : {0.0, 30.0}) {
    const Vec3d where = Vec3d{0.7, -0.6, 0.9} * far;
    for (const Vec3d stretch : {Vec3d{1, 1, 1}, Vec3d{1, 0.001, 0.3}}) {
      const Surface<T> ball = placed<T>(sphere(2, 1), stretch, where);
      out += count_leaks<Test, T>(ball, {Vec3<T>(where), (ball.positions[0] + ball.positions[5]) * T(0.5)},
                                  rays);
    }
    const Surface<T> ring = placed<T>(torus(1, 0.3, 16, 12), {1, 1, 1}, where);
    Vec3d middle;  // of the first section of the tube
    for (std::size_t i = 0; i < 12; ++i) middle += Vec3d(ring.positions[i]) / 12.0;
    out += count_leaks<Test, T>(ring, {Vec3<T>(middle)}, rays);
  }
  return out;
}

TEST(SegmentTriangleLeaks, WatertightLetsNoRayOutOfAClosedMesh) {
  int rays = 0;
  EXPECT_EQ((count_all_leaks<Watertight, float>(rays)), 0);
  EXPECT_EQ((count_all_leaks<Watertight, double>(rays)), 0);
  EXPECT_GT(rays, 20'000);
}

/// Other tests must leak, or the rays are too easy.
TEST(SegmentTriangleLeaks, TheRaysFindTheHolesOfTheOtherTests) {
  int rays = 0;
  EXPECT_GT((count_all_leaks<PlaneProjection, float>(rays)), 0);
  EXPECT_GT((count_all_leaks<Inclusion, float>(rays)), 0);
  EXPECT_GT((count_all_leaks<MoellerTrumbore, float>(rays)), 0);
}

/// A sliver around the ray, so thin that all three areas round to zero; their exact values are 2 u^2, u^2 and
/// u^2 with u = 2^-23. In a mesh of such slivers it is the only triangle that contains the ray.
TEST(SegmentTriangleLeaks, WatertightSeesWhatRoundsToNothing) {
  const float u = std::numeric_limits<float>::epsilon();
  const Corners<float> sliver{{1 + u, 1, 5}, {-1, u - 1, 5}, {-1 - 2 * u, -1 - u, 5}};
  const Segment<float> along_z{{0, 0, 0}, {0, 0, 10}};
  const Crossing<float> found = find_crossing<Watertight>(along_z, sliver);
  EXPECT_EQ(found.side, -1);
  EXPECT_EQ(found.t, 0.5f);
  EXPECT_EQ(found.weight, (Vec3f{0.5f, 0.25f, 0.25f}));

  // In some lanes of a pack.
  std::vector<float> numbers[3][3];
  const Corners<float> other{{1, 0, 3}, {-1, 1, 3}, {-1, -1, 3}};
  TriangleColumns columns;
  columns.count = 32;
  for (std::size_t k = 0; k < 3; ++k)
    for (int j = 0; j < 3; ++j) {
      for (std::size_t i = 0; i < columns.count; ++i) {
        const Corners<float>& one = i % 3 == 0 ? sliver : other;
        numbers[k][j].push_back((k == 0 ? one.a : (k == 1 ? one.b : one.c))[j]);
      }
      columns.corner[k][j] = numbers[k][j].data();
    }
  std::vector<float> t(columns.count), a(t), b(t), c(t), side(t);
  find_crossings(SegmentTest::watertight, along_z, columns,
                 {t.data(), {a.data(), b.data(), c.data()}, side.data()});
  for (std::size_t i = 0; i < columns.count; ++i) EXPECT_EQ(t[i], i % 3 == 0 ? 0.5f : 0.3f) << i;
}

/// A ray from outside through a point inside enters and leaves.
TEST(SegmentTriangleLeaks, WhatEntersLeaves) {
  const Surface<float> ball = placed<float>(sphere(3, 1), {1, 1, 1}, {3, -2, 5});
  const Vec3f middle{3, -2, 5};
  Random random(22);
  for (std::size_t i = 0; i < 3000; ++i) {
    const Vec3f corner = ball.positions[i % ball.positions.size()];
    const Vec3f outside = middle + Vec3f(random.point(-1, 1)) + (corner - middle) * 4.0f;
    bool enters = false, leaves = false;
    Watertight::prepare<float>(ray_to(outside, middle), [&](const auto& crosses_ray) {
      for (const Triangle& triangle : ball.triangles) {
        const float side = crosses_ray(ball.corners(triangle)).side;
        enters |= side > 0, leaves |= side < 0;
      }
    });
    ASSERT_TRUE(enters && leaves) << i;
  }
}

}  // namespace souple::test::test_segment_triangle_leaks
