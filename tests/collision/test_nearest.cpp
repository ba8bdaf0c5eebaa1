#include "souple/collision/nearest.h"
#include "souple/geometry/closest_point.h"
#include "souple/simd/pack.h"
#include "tests/collision/random.h"

#include <array>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace souple::test_collision_nearest {

using test::Random;

double to_edge(const Vec3d& p, const Vec3d& a, const Vec3d& b) {
  const double squared = length_squared(b - a);
  const double s = squared > 0 ? max(0.0, min(1.0, dot(p - a, b - a) / squared)) : 0;
  return length(a + (b - a) * s - p);
}

/// The minimum of the distances by Ericson's regions and to the edges. Each is a distance to a point of the
/// triangle, and so is the tested one. So the tested one cannot be too small, and an upper bound suffices.
double to_triangle(const Vec3d& p, const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const TrianglePoint w = closest_on_triangle(p, a, b, c);
  const double regions = length(a * w.a + b * w.b + c * w.c - p);
  return min(min(regions, to_edge(p, a, b)), min(to_edge(p, b, c), to_edge(p, c, a)));
}

/// Distance of two edges: from the origin to the parallelogram of their differences.
double between_edges(const Vec3d& p0, const Vec3d& p1, const Vec3d& q0, const Vec3d& q1) {
  return min(to_triangle({}, p0 - q0, p1 - q0, p0 - q1), to_triangle({}, p1 - q1, p1 - q0, p0 - q1));
}

/// Four points of one of several kinds: ordinary, slivers, collinear, coincident, flat or far away.
std::array<Vec3d, 4> points(Random& random, int kind) {
  std::array<Vec3d, 4> x;
  for (Vec3d& v : x) v = random.point(-1, 1);
  const double small = std::ldexp(1.0, -int(random.uniform(2, 40)));
  const auto near = [&](const Vec3d& at) { return at + random.point(-small, small); };
  if (kind == 1) x[3] = near(x[1] + (x[2] - x[1]) * random.uniform(-1, 2));  // sliver, or nearly collinear
  if (kind == 2) x[2] = x[1] + (x[3] - x[1]) * 0.5;
  if (kind == 3) x[2] = x[1];
  if (kind == 4) x[1] = x[2] = x[3] = near(x[0]);
  if (kind == 5) x[0] = near(x[1] * 0.25 + x[2] * 0.25 + x[3] * 0.5);        // near an interior point
  if (kind == 6) x[3] = near(x[2] + (x[1] - x[0]) * random.uniform(-1, 1));  // nearly parallel edges
  if (kind == 7) x[3] = x[2] + (x[1] - x[0]);
  if (kind == 8) x[0] = x[1] = x[2] = x[3];
  if (kind == 9)
    for (Vec3d& v : x) v.z = 0;
  // Each is exact in float, so that only the method is compared.
  for (Vec3d& v : x) v = Vec3d(Vec3f(v));
  return x;
}
constexpr int kinds = 10;

template <class T>
void expect_nearest_on_triangle(const std::array<Vec3d, 4>& x, double tolerance) {
  T w[3];
  nearest_on_triangle(Vec3<T>(x[0]), Vec3<T>(x[1]), Vec3<T>(x[2]), Vec3<T>(x[3]), w);
  for (const T v : w) ASSERT_GE(v, 0);  // and no NaN
  ASSERT_NEAR(double(w[0] + w[1] + w[2]), 1, 4 * double(std::numeric_limits<T>::epsilon()));
  const Vec3d q = x[1] * double(w[0]) + x[2] * double(w[1]) + x[3] * double(w[2]);
  ASSERT_LE(length(q - x[0]), to_triangle(x[0], x[1], x[2], x[3]) + tolerance);
}

template <class T>
void expect_nearest_on_edges(const std::array<Vec3d, 4>& x, double tolerance) {
  T s = -1, t = -1;
  nearest_on_edges(Vec3<T>(x[0]), Vec3<T>(x[1]), Vec3<T>(x[2]), Vec3<T>(x[3]), s, t);
  ASSERT_TRUE(s >= 0 && s <= 1 && t >= 0 && t <= 1);
  const Vec3d p = x[0] + (x[1] - x[0]) * double(s), q = x[2] + (x[3] - x[2]) * double(t);
  ASSERT_LE(length(p - q), between_edges(x[0], x[1], x[2], x[3]) + tolerance);
}

// Coordinates of size 1: the bound is in units of eps, whatever the shape.
TEST(Nearest, TriangleWithinRoundingForAnyShape) {
  Random random(11);
  for (int k = 0; k < 200000; ++k) {
    const auto x = points(random, k % kinds);
    ASSERT_NO_FATAL_FAILURE(expect_nearest_on_triangle<float>(x, 1.2e-6)) << "kind " << k % kinds;
    ASSERT_NO_FATAL_FAILURE(expect_nearest_on_triangle<double>(x, 1e-14)) << "kind " << k % kinds;
  }
}

TEST(Nearest, EdgesWithinRoundingForAnyShape) {
  Random random(12);
  for (int k = 0; k < 200000; ++k) {
    const auto x = points(random, k % kinds);
    ASSERT_NO_FATAL_FAILURE(expect_nearest_on_edges<float>(x, 1.2e-6)) << "kind " << k % kinds;
    ASSERT_NO_FATAL_FAILURE(expect_nearest_on_edges<double>(x, 1e-14)) << "kind " << k % kinds;
  }
}

// A point above the interior, and two edges that cross at an angle: the results are known by construction.
TEST(Nearest, WeightsAreTheOnesPutIn) {
  Random random(13);
  for (int k = 0; k < 20000; ++k) {
    const Vec3d a = random.point(-1, 1), b = random.point(-1, 1), c = random.point(-1, 1);
    const Vec3d n = cross(b - a, c - a);
    if (length(n) < 0.1) continue;
    const double u = random.uniform(0.05, 0.5), v = random.uniform(0.05, 0.45);
    const Vec3d foot = a * (1 - u - v) + b * u + c * v;
    const Vec3d p = foot + n * random.uniform(-1, 1);
    float w[3];
    nearest_on_triangle(Vec3f(p), Vec3f(a), Vec3f(b), Vec3f(c), w);
    EXPECT_NEAR(w[1], u, 1e-4);
    EXPECT_NEAR(w[2], v, 1e-4);
    float s = 0, t = 0;
    const Vec3d q0 = foot + (p - foot) - (c - a) * u, q1 = q0 + (c - a);
    nearest_on_edges(Vec3f(foot - (b - a) * v), Vec3f(foot + (b - a) * (1 - v)), Vec3f(q0), Vec3f(q1), s, t);
    EXPECT_NEAR(s, v, 1e-4);
    EXPECT_NEAR(t, u, 1e-4);
  }
}

TEST(Nearest, ParallelEdgesMeetWhereTheyOverlap) {
  float s = -1, t = -1;
  nearest_on_edges(Vec3f{0, 0, 0}, Vec3f{1, 0, 0}, Vec3f{0.25f, 1, 0}, Vec3f{3, 1, 0}, s, t);
  EXPECT_FLOAT_EQ(s * 1.0f, 0.25f + 2.75f * t);
  nearest_on_edges(Vec3f{0, 0, 0}, Vec3f{1, 0, 0}, Vec3f{2, 1, 0}, Vec3f{3, 1, 0}, s, t);
  EXPECT_EQ(s, 1);
  EXPECT_EQ(t, 0);
}

#if defined(__SSE2__) || defined(__aarch64__)
#if defined(__SSE2__)
using Pack = simd::Pack<simd::Sse>;
#else
using Pack = simd::Pack<simd::Neon>;
#endif

/// Point i of each of a pack's lanes.
Vec3<Pack> gather(const std::array<Vec3d, 4> (&x)[Pack::lanes], std::size_t i) {
  float v[3][Pack::lanes];
  for (int lane = 0; lane < Pack::lanes; ++lane)
    for (int axis = 0; axis < 3; ++axis) v[axis][lane] = float(x[lane][i][axis]);
  return {Pack::load(v[0]), Pack::load(v[1]), Pack::load(v[2])};
}

TEST(Nearest, PacksHoldTheBitsOfFloat) {
  Random random(14);
  for (int k = 0; k < 20000; ++k) {
    std::array<Vec3d, 4> x[Pack::lanes];
    for (int lane = 0; lane < Pack::lanes; ++lane) x[lane] = points(random, (k + lane) % kinds);
    Pack weight[3], s, t;
    nearest_on_triangle(gather(x, 0), gather(x, 1), gather(x, 2), gather(x, 3), weight);
    nearest_on_edges(gather(x, 0), gather(x, 1), gather(x, 2), gather(x, 3), s, t);
    float packed[5][Pack::lanes];
    for (int i = 0; i < 3; ++i) weight[i].store(packed[i]);
    s.store(packed[3]);
    t.store(packed[4]);
    for (int lane = 0; lane < Pack::lanes; ++lane) {
      const Vec3f p[4] = {Vec3f(x[lane][0]), Vec3f(x[lane][1]), Vec3f(x[lane][2]), Vec3f(x[lane][3])};
      float w[3], one_s = 0, one_t = 0;
      nearest_on_triangle(p[0], p[1], p[2], p[3], w);
      nearest_on_edges(p[0], p[1], p[2], p[3], one_s, one_t);
      for (int i = 0; i < 3; ++i) ASSERT_EQ(packed[i][lane], w[i]);
      ASSERT_EQ(packed[3][lane], one_s);
      ASSERT_EQ(packed[4][lane], one_t);
    }
  }
}
#endif

}  // namespace souple::test_collision_nearest
