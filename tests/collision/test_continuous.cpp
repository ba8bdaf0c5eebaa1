#include "souple/collision/continuous.h"
#include "souple/collision/cubic.h"
#include "souple/geometry/closest_point.h"
#include "tests/collision/exact_cubic.h"
#include "tests/collision/random.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace souple::test_collision_continuous {

// The time of first contact in exact arithmetic, from the same doubles. Let V(t) be the volume of the four particles.
// Contact is at a root of V where the point in the plane is inside the triangle, or the lines intersect inside the
// edges. If V is zero throughout, a particle first touches an edge or another particle.

using test::Polynomial;
using test::Random;
using test::Rational;
using test::RootCounter;

enum class Kind { vertex_triangle, edge_edge };

double time_of(Kind kind, const Moving4& m, double gap) {
  return kind == Kind::vertex_triangle ? vertex_triangle_time(m, gap) : edge_edge_time(m, gap);
}

// ---- exact ----

struct Vec3p {
  Polynomial x, y, z;
  friend Vec3p operator-(const Vec3p& a, const Vec3p& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
};
Polynomial dot(const Vec3p& a, const Vec3p& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
Vec3p cross(const Vec3p& a, const Vec3p& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
Polynomial path(double from, double to) {
  return test::trimmed({Rational(from), Rational(to) - Rational(from)});
}

struct Paths {
  Vec3p x[4];
  explicit Paths(const Moving4& m) {
    for (int i = 0; i < 4; ++i)
      x[i] = {path(m.x[i].x, m.p[i].x), path(m.x[i].y, m.p[i].y), path(m.x[i].z, m.p[i].z)};
  }
};

const Rational width = Rational(1) / Rational("1152921504606846976");  // 2^-60

/// Earliest root of `zero` in [0, 1] with all `conditions` >= 0 at both ends of its interval.
std::optional<double> earliest(const Polynomial& zero, const std::vector<Polynomial>& conditions) {
  const auto hold = [&](const Rational& t) {
    for (const Polynomial& c : conditions)
      if (value_at(c, t) < 0) return false;
    return true;
  };
  if (zero.empty()) {  // the first time at which all conditions hold is 0 or a root of a condition
    if (hold(0)) return 0;
    std::optional<double> first;
    for (const Polynomial& c : conditions) {
      if (c.empty()) continue;
      for (const auto& root : RootCounter(c).isolate(0, 1, width))
        if (hold(root.hi) && (!first || root.hi < *first)) first = root.lo.get_d();
    }
    return first;
  }
  for (const auto& root : RootCounter(zero).isolate(0, 1, width))
    if (hold(root.lo) && hold(root.hi)) return root.lo.get_d();
  return {};
}

std::optional<double> contact_with_edge(const Vec3p& p, const Vec3p& a, const Vec3p& b) {
  const Vec3p n = cross(a - p, b - p);
  return earliest(dot(n, n), {dot(a - p, b - p) * Polynomial{-1}});
}

void take(std::optional<double>& first, std::optional<double> other) {
  if (other && (!first || *other < *first)) first = other;
}

std::optional<double> first_contact(Kind kind, const Moving4& m) {
  const Paths at(m);
  const auto& x = at.x;
  const bool vertex = kind == Kind::vertex_triangle;
  const Polynomial V = dot(cross(x[1] - x[0], x[2] - x[0]), x[3] - x[0]);
  if (!V.empty() && vertex) {
    const Vec3p n = cross(x[2] - x[1], x[3] - x[1]), a = x[1] - x[0], b = x[2] - x[0], c = x[3] - x[0];
    // Strictly positive area: a triangle that folds to a line is not in contact by this condition.
    return earliest(V, {dot(n, cross(b, c)), dot(n, cross(c, a)), dot(n, cross(a, b)),
                        dot(n, n) - Polynomial{Rational(1e-40)}});
  }
  if (!V.empty()) {
    const Vec3p d = x[1] - x[0], e = x[3] - x[2], r = x[2] - x[0], n = cross(d, e);
    const Polynomial s = dot(cross(r, e), n), t = dot(cross(r, d), n), all = dot(n, n);
    return earliest(V, {s, t, all - s, all - t, all - Polynomial{Rational(1e-40)}});
  }
  std::optional<double> first;
  if (vertex) {
    for (int i = 1; i < 4; ++i) take(first, contact_with_edge(x[0], x[i], x[i % 3 + 1]));
  } else {
    for (int i = 0; i < 2; ++i) {
      take(first, contact_with_edge(x[i], x[2], x[3]));
      take(first, contact_with_edge(x[i + 2], x[0], x[1]));
    }
  }
  return first;
}

// ---- distances in double ----

double point_triangle(const Vec3d& p, const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  double least = std::numeric_limits<double>::max();
  const Vec3d corner[3] = {a, b, c};
  for (int i = 0; i < 3; ++i) {
    const Vec3d u = corner[i], v = corner[(i + 1) % 3];
    const double squared = length_squared(v - u);
    const double s = squared > 0 ? max(0.0, min(1.0, dot(p - u, v - u) / squared)) : 0;
    least = min(least, length(u + (v - u) * s - p));
  }
  const TrianglePoint w = closest_on_triangle(p, a, b, c);
  return min(least, length((a - p) * w.a + (b - p) * w.b + (c - p) * w.c));
}

/// Distance of two edges: from the origin to the parallelogram of their differences.
double distance_at(Kind kind, const Moving4& m, double t) {
  Vec3d x[4];
  for (int i = 0; i < 4; ++i) x[i] = m.x[i] * (1 - t) + m.p[i] * t;
  if (kind == Kind::vertex_triangle) return point_triangle(x[0], x[1], x[2], x[3]);
  return min(point_triangle({}, x[0] - x[2], x[1] - x[2], x[0] - x[3]),
             point_triangle({}, x[1] - x[3], x[1] - x[2], x[0] - x[3]));
}

double fastest(const Moving4& m) {
  double v = 0;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < i; ++j) v = max(v, length((m.p[i] - m.x[i]) - (m.p[j] - m.x[j])));
  return v;
}

double extent(const Moving4& m) {
  double size = 0;
  for (int i = 0; i < 4; ++i) size = max(size, max(length(m.x[i] - m.x[0]), length(m.p[i] - m.p[0])));
  return size;
}

/// The lower bound of the distance that the header guarantees.
double bound(Kind kind, const Moving4& m, double gap) {
  const double begin = distance_at(kind, m, 0);
  return begin > gap ? max(gap, begin / 1024) : begin / 10;
}

// ---- motions ----

Vec3d on_grid(const Vec3d& v) {
  return {std::round(v.x * 256) / 256, std::round(v.y * 256) / 256, std::round(v.z * 256) / 256};
}

enum Motion {
  anything,
  crossing,
  rotating,
  sliding,
  grazing,
  coplanar,
  oblique_coplanar,
  fast,
  tiny,
  sliver,
  parallel,
  resting,
  hairline,
  motions
};

Vec3d turned(const Vec3d& v, double angle) {
  return {v.x * std::cos(angle) - v.z * std::sin(angle), v.y, v.x * std::sin(angle) + v.z * std::cos(angle)};
}

Moving4 motion(Kind kind, int which, Random& random) {
  Moving4 m;
  for (int i = 0; i < 4; ++i) m.x[i] = random.point(-1, 1), m.p[i] = random.point(-1, 1);
  const auto all = [&](auto&& change) {
    for (int i = 0; i < 4; ++i) m.x[i] = change(m.x[i]), m.p[i] = change(m.p[i]);
  };
  // One element at y = 0 and the other above it; the code below moves the upper one.
  const int flat = kind == Kind::vertex_triangle ? 1 : 2;
  const auto lay_down = [&](double height) {
    for (int i = 0; i < 4; ++i) m.p[i] = m.x[i] = {m.x[i].x, i < flat ? height : 0, m.x[i].z};
  };
  const double height = std::ldexp(1.0, -int(random.uniform(1, 30)));
  const Vec3d shift = random.point(-2, 2);
  switch (which) {
    case crossing:
      lay_down(random.uniform(0.1, 1));
      for (int i = 0; i < flat; ++i) m.p[i] += Vec3d{0.2 * shift.x, -random.uniform(0, 3), 0.2 * shift.z};
      for (int i = 0; i < 4; ++i) m.p[i] += random.point(-0.1, 0.1);
      break;
    case rotating: {
      const double angle = random.uniform(-3, 3);
      for (int i = 0; i < flat; ++i) m.p[i] = turned(m.x[i], angle);
      break;
    }
    case sliding:
      lay_down(height);
      for (int i = 0; i < flat; ++i) m.p[i] += Vec3d{shift.x, 0, shift.z};
      break;
    case grazing: {  // particle 0 passes exactly through particle 3 or the middle of 2, 3, at half time
      all(on_grid);
      const bool corner = random.uniform(0, 1) < 0.5;
      const Vec3d at = corner ? m.x[3] + m.p[3] : (m.x[3] + m.p[3] + m.x[2] + m.p[2]) * 0.5;
      m.p[0] = at - m.x[0];
      break;
    }
    case coplanar:
    case oblique_coplanar:
      all(on_grid);
      all([&](const Vec3d& v) { return Vec3d{v.x, 0, v.z}; });
      if (which == oblique_coplanar)
        all([](const Vec3d& v) { return Vec3d{v.x, v.x * 0.5 + v.z * 0.25, v.z}; });
      break;
    case fast:
      for (int i = 0; i < flat; ++i)
        m.p[i] = m.x[i] + (m.p[i] - m.x[i]) * std::ldexp(1.0, int(random.uniform(0, 30)));
      break;
    case tiny: {
      const double size = std::ldexp(1.0, -int(random.uniform(5, 40)));
      all([&](const Vec3d& v) { return v * size; });
      break;
    }
    case sliver:
      m.x[3] = m.x[1] + (m.x[2] - m.x[1]) * 0.4 + random.point(-height, height);
      m.p[3] = m.p[1] + (m.p[2] - m.p[1]) * 0.4 + random.point(-height, height);
      break;
    case parallel:
      m.x[3] = m.x[2] + (m.x[1] - m.x[0]) + random.point(-height, height);
      m.p[3] = m.p[2] + (m.p[1] - m.p[0]) + random.point(-height, height);
      break;
    case resting:
      lay_down(height);
      for (int i = 0; i < 4; ++i) m.p[i] += random.point(-3, 3) * height;
      break;
    case hairline:  // near the limit of rounding
      lay_down(height * 3e-5);
      for (int i = 0; i < 4; ++i) m.p[i] += random.point(-1, 1) * height;
      break;
    default:
      break;
  }
  return m;
}

void describe(const Moving4& m) {
  for (int i = 0; i < 4; ++i)
    std::printf("  {%.17g, %.17g, %.17g} -> {%.17g, %.17g, %.17g}\n", m.x[i].x, m.x[i].y, m.x[i].z, m.p[i].x,
                m.p[i].y, m.p[i].z);
}

class Continuous : public testing::TestWithParam<Kind> {};

/// Besides the guarantee, tests the accuracy of the result. It is 0.995 of the time of first contact on average, and
/// below 0.9 in one of 200 motions. Their distance may come near its bound before contact.
void compare_with_exact(Kind kind, int cases, std::uint64_t seed) {
  Random random(seed);
  int touches[motions] = {};
  int behind = 0;
  double worst = 1, sum = 0;
  for (int k = 0; k < motions * cases; ++k) {
    const int which = k % motions;
    const Moving4 m = motion(kind, which, random);
    if (distance_at(kind, m, 0) < 1e-13 * extent(m)) continue;  // starts in contact
    const auto contact = first_contact(kind, m);
    if (!contact) continue;
    const double t = time_of(kind, m, 0);
    if (!(t < *contact)) describe(m);
    ASSERT_LT(t, *contact) << "motion " << which;
    ++touches[which];
    sum += t / *contact;
    if (t / *contact < 0.9) ++behind;
    worst = min(worst, t / *contact);
  }
  int all = 0;
  for (const int n : touches) all += n;
  testing::Test::RecordProperty("touches", all);
  testing::Test::RecordProperty("worst_ratio", std::to_string(worst));
  testing::Test::RecordProperty("mean_ratio", std::to_string(sum / all));
  testing::Test::RecordProperty("behind", behind);
  EXPECT_GT(sum / all, 0.995);
  EXPECT_LE(behind, all / 200);
  for (const int which : {crossing, rotating, coplanar, oblique_coplanar, fast, tiny})
    EXPECT_GT(touches[which], 0);
  EXPECT_EQ(touches[grazing], cases);
}

TEST_P(Continuous, NeverPastTheFirstTouchOfExactArithmetic) {
  ASSERT_NO_FATAL_FAILURE(compare_with_exact(GetParam(), 40, 21));
}

TEST_P(Continuous, NeverPastTouchSlow) {
  ASSERT_NO_FATAL_FAILURE(compare_with_exact(GetParam(), 1500, 23));
}

TEST_P(Continuous, KeepsItsDistanceAndStopsOnlyWhenNear) {
  Random random(22);
  constexpr int cases = motions * 2000;
  int stopped = 0, passed = 0, early = 0;
  for (int k = 0; k < cases; ++k) {
    const int which = k % motions;
    const Moving4 m = motion(GetParam(), which, random);
    const double begin = distance_at(GetParam(), m, 0);
    const double gap = begin * std::ldexp(1.0, int(random.uniform(-12, 3))) * 1.1;
    const double least = bound(GetParam(), m, gap), t = time_of(GetParam(), m, gap);
    const double rounding = 1e-13 * (1 + fastest(m));
    constexpr int samples = 100;
    double lowest = begin;
    for (int i = 0; i <= samples; ++i) {
      const double now = distance_at(GetParam(), m, t * i / samples);
      if (now < least - rounding) describe(m);
      ASSERT_GE(now, least - rounding) << "motion " << which << " gap " << gap << " t " << t << " i " << i;
      lowest = min(lowest, now);
    }
    if (t == 1) {
      ++passed;
      continue;
    }
    ++stopped;
    if (distance_at(GetParam(), m, t) <= 1.05 * least + rounding) continue;
    // Only with fast rotation, or in the plane, the result is sometimes earlier.
    ++early;
    ASSERT_TRUE(which == fast || which == rotating || which == coplanar || which == oblique_coplanar)
        << "motion " << which;
  }
  RecordProperty("early", early);
  EXPECT_LE(early, cases / 1000);
  EXPECT_GT(stopped, 1000);
  EXPECT_GT(passed, 1000);
}

TEST_P(Continuous, WhatPassesByOrPartsIsFree) {
  const bool vertex = GetParam() == Kind::vertex_triangle;
  Moving4 m;
  m.x[0] = {0.2, 1e-3, 0.2};
  m.x[1] = vertex ? Vec3d{0, 0, 0} : Vec3d{0.2, 1e-3, 0.8};
  m.x[2] = vertex ? Vec3d{1, 0, 0} : Vec3d{0, 0, 0.5};
  m.x[3] = vertex ? Vec3d{0, 0, 1} : Vec3d{1, 0, 0.5};
  for (int i = 0; i < 4; ++i) m.p[i] = m.x[i];
  EXPECT_EQ(time_of(GetParam(), m, 0), 1);  // at rest

  const auto move_upper = [&](const Vec3d& by) {
    Moving4 moved = m;
    for (int i = 0; i < (vertex ? 1 : 2); ++i) moved.p[i] += by;
    return moved;
  };
  EXPECT_EQ(time_of(GetParam(), move_upper({0.5, 0, 0.3}), 9e-4), 1);
  EXPECT_EQ(time_of(GetParam(), move_upper({1e6, 0, 0}), 9e-4), 1);
  EXPECT_EQ(time_of(GetParam(), move_upper({1, 1e-3, 0}), 1), 1);
  EXPECT_NEAR(time_of(GetParam(), move_upper({0, -2e-3, 0}), 0), 0.5, 1e-3);
  EXPECT_NEAR(time_of(GetParam(), move_upper({0, -2e-3, 0}), 1), 0.45, 1e-3);
  EXPECT_NEAR(time_of(GetParam(), move_upper({0, -2e-3, 0}), 5e-4), 0.25, 1e-9);
  EXPECT_NEAR(time_of(GetParam(), move_upper({0, -1e5, 0}), 0) * 1e8, 1, 2e-3);
}

TEST_P(Continuous, InTouchAtTheBeginItMayOnlyPart) {
  const bool vertex = GetParam() == Kind::vertex_triangle;
  Moving4 m;
  m.x[0] = {0.25, 0, 0.25};
  m.x[1] = vertex ? Vec3d{0, 0, 0} : Vec3d{0.25, 0, 0.75};
  m.x[2] = vertex ? Vec3d{1, 0, 0} : Vec3d{0, 0, 0.5};
  m.x[3] = vertex ? Vec3d{0, 0, 1} : Vec3d{1, 0, 0.5};
  for (int i = 0; i < 4; ++i) m.p[i] = m.x[i];
  EXPECT_EQ(time_of(GetParam(), m, 1e-3), 0);
  m.p[0].y = m.p[1].y = 0.1;
  if (vertex) m.p[1].y = 0;
  EXPECT_EQ(time_of(GetParam(), m, 1e-3), 1);
  for (int i = 0; i < 4; ++i) m.x[i] = m.p[i] = {1, 2, 3};
  EXPECT_EQ(time_of(GetParam(), m, 1e-3), 0);
}

TEST_P(Continuous, NotFiniteIsNotSafe) {
  Random random(25);
  for (const double invalid : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    for (int i = 0; i < 8; ++i) {
      Moving4 m = motion(GetParam(), anything, random);
      (i < 4 ? m.x[i] : m.p[i - 4]).y = invalid;
      EXPECT_EQ(time_of(GetParam(), m, 1e-3), 0);
    }
  }
}

/// A vertex and an edge, as two edges: the vertex is an edge to itself.
Moving4 vertex_to_edge(int which, Random& random) {
  Moving4 m = motion(Kind::edge_edge, which, random);
  m.x[1] = m.x[0];
  m.p[1] = m.p[0];
  return m;
}

// The two collide only in motions that aim them at each other: in a plane, or at one moment.
TEST(ContinuousVertexEdge, NeverPastTheFirstTouchOfExactArithmetic) {
  Random random(26);
  int touches = 0, behind = 0;
  double sum = 0;
  for (int k = 0; k < 600; ++k) {
    const int which = std::array{grazing, coplanar, oblique_coplanar}[std::size_t(k % 3)];
    const Moving4 m = vertex_to_edge(which, random);
    const auto contact = first_contact(Kind::edge_edge, m);
    if (!contact || distance_at(Kind::edge_edge, m, 0) < 1e-13 * extent(m)) continue;
    const double t = edge_edge_time(m, 0);
    if (!(t < *contact)) describe(m);
    ASSERT_LT(t, *contact) << "motion " << which;
    ++touches;
    sum += t / *contact;
    behind += t / *contact < 0.9 ? 1 : 0;
  }
  RecordProperty("touches", touches);
  RecordProperty("mean_ratio", std::to_string(sum / touches));
  RecordProperty("behind", behind);
  EXPECT_GT(touches, 250);
  EXPECT_GT(sum / touches, 0.995);
  EXPECT_LE(behind, touches / 100);
}

TEST(ContinuousVertexEdge, KeepsItsDistanceAndStopsOnlyWhenNear) {
  Random random(27);
  int stopped = 0, early = 0;
  for (int k = 0; k < motions * 1000; ++k) {
    const Moving4 m = vertex_to_edge(k % motions, random);
    const double begin = distance_at(Kind::edge_edge, m, 0);
    const double gap = begin * std::ldexp(1.0, int(random.uniform(-12, 3))) * 1.1;
    const double least = bound(Kind::edge_edge, m, gap), t = edge_edge_time(m, gap);
    const double rounding = 1e-13 * (1 + fastest(m));
    for (int i = 0; i <= 100; ++i)
      ASSERT_GE(distance_at(Kind::edge_edge, m, t * i / 100), least - rounding) << "motion " << k % motions;
    if (t == 1) continue;
    ++stopped;
    early += distance_at(Kind::edge_edge, m, t) > 1.05 * least + rounding ? 1 : 0;
  }
  RecordProperty("early", early);
  EXPECT_GT(stopped, 1000);
  EXPECT_LE(early, motions);
}

INSTANTIATE_TEST_SUITE_P(Kinds, Continuous, testing::Values(Kind::vertex_triangle, Kind::edge_edge),
                         [](const auto& kind) {
                           return kind.param == Kind::vertex_triangle ? "VertexTriangle" : "EdgeEdge";
                         });

Polynomial exact(const double (&c)[4]) {
  return test::trimmed({Rational(c[0]), Rational(c[1]), Rational(c[2]), Rational(c[3])});
}

/// Every root that exact arithmetic finds in [0, 1] is in an interval; intervals are in order and within [0,
/// 1].
void expect_all_roots(const double (&c)[4], const Polynomial& truth, double error) {
  const CubicRoots found = cubic_roots(c, error);
  double last = -1;
  for (int k = 0; k < found.count; ++k) {
    ASSERT_LT(last, found.interval[k].lo);
    ASSERT_LE(found.interval[k].lo, found.interval[k].hi);
    ASSERT_GE(found.interval[k].lo, 0);
    last = found.interval[k].hi;
  }
  ASSERT_LE(last, 1);
  if (truth.empty()) {
    ASSERT_EQ(found.count, 1);
    ASSERT_EQ(found.interval[0].hi - found.interval[0].lo, 1);
    return;
  }
  const RootCounter counter(truth);
  int inside = 0;
  for (int k = 0; k < found.count; ++k)
    inside += counter.count(Rational(found.interval[k].lo), Rational(found.interval[k].hi));
  ASSERT_EQ(inside, counter.count(0, 1)) << c[0] << " " << c[1] << " " << c[2] << " " << c[3];
}

/// factor (t - r0)(t - r1)(t - r2), rounded to doubles.
void expand(double factor, const double (&r)[3], double (&c)[4]) {
  c[0] = -factor * r[0] * r[1] * r[2];
  c[1] = factor * (r[0] * r[1] + r[1] * r[2] + r[2] * r[0]);
  c[2] = -factor * (r[0] + r[1] + r[2]);
  c[3] = factor;
}

TEST(Cubic, FindsEveryRootOfRandomCoefficients) {
  Random random(1);
  for (int k = 0; k < 4000; ++k) {
    double c[4];
    for (double& v : c) v = random.uniform(-1, 1);
    expect_all_roots(c, exact(c), 0);
  }
}

TEST(Cubic, FindsEveryRootOfCoefficientsOfAllSizes) {
  Random random(2);
  for (int k = 0; k < 4000; ++k) {
    double c[4];
    for (double& v : c) {
      v = std::ldexp(random.uniform(-1, 1), int(random.uniform(-70, 0)));
      if (random.uniform(0, 1) < 0.2) v = 0;
    }
    const int scale = int(random.uniform(-1, 2)) * 950;
    for (double& v : c) v = std::ldexp(v, scale);
    expect_all_roots(c, exact(c), 0);
  }
}

// Dyadic roots with few bits give exact coefficients, hence exactly double and triple roots.
TEST(Cubic, FindsDoubleAndTripleRootsAndRootsAtTheEnds) {
  Random random(3);
  const auto root = [&] {
    const double r = std::floor(random.uniform(-2, 18)) / 16;
    return random.uniform(0, 1) < 0.3 ? std::round(r) : r;
  };
  for (int k = 0; k < 4000; ++k) {
    double r[3] = {root(), root(), root()};
    const double kind = random.uniform(0, 1);
    if (kind < 0.6) r[1] = r[0];
    if (kind < 0.2) r[2] = r[0];
    double c[4];
    expand(std::ldexp(1.0, int(random.uniform(-900, 900))), r, c);
    expect_all_roots(c, exact(c), 0);
  }
}

// Rounding splits or removes a double root, by the square root of eps. Compares with the exact roots of the
// rounded coefficients.
TEST(Cubic, FindsNearlyDoubleAndTripleRoots) {
  Random random(4);
  for (int k = 0; k < 4000; ++k) {
    const double near = std::ldexp(1.0, -int(random.uniform(5, 60)));
    double r[3] = {random.uniform(0, 1), random.uniform(-0.2, 1.2), random.uniform(-3, 3)};
    r[1] = r[0] + random.uniform(-near, near);
    if (random.uniform(0, 1) < 0.4) r[2] = r[0] + random.uniform(-near, near);
    double c[4];
    expand(1, r, c);
    if (random.uniform(0, 1) < 0.5) c[0] = std::nextafter(c[0], random.uniform(-1, 1));
    expect_all_roots(c, exact(c), 0);
  }
}

TEST(Cubic, ErrorsOfTheCoefficientsAreHeld) {
  Random random(5);
  for (int k = 0; k < 4000; ++k) {
    double r[3] = {random.uniform(0, 1), random.uniform(-0.2, 1.2), random.uniform(-0.2, 1.2)};
    if (random.uniform(0, 1) < 0.5) r[1] = r[0];
    double truth[4], c[4];
    expand(1, r, truth);
    const double size = std::ldexp(1.0, -int(random.uniform(2, 50)));
    double error = 0;
    for (int i = 0; i < 4; ++i) {
      c[i] = truth[i] + random.uniform(-size, size);
      error += std::abs(c[i] - truth[i]);
    }
    expect_all_roots(c, exact(truth), error * (1 + 1e-15));
  }
}

TEST(Cubic, SimpleRootsAreTight) {
  Random random(6);
  for (int k = 0; k < 2000; ++k) {
    const double r[3] = {random.uniform(0, 0.3), random.uniform(0.35, 0.6), random.uniform(0.7, 1)};
    double c[4];
    expand(random.uniform(1, 100), r, c);
    const CubicRoots found = cubic_roots(c);
    ASSERT_EQ(found.count, 3);
    for (int i = 0; i < 3; ++i) {
      ASSERT_NEAR(found.interval[i].lo, r[i], 2e-11);
      ASSERT_NEAR(found.interval[i].hi, r[i], 2e-11);
    }
  }
}

TEST(Cubic, NoRootNoInterval) {
  Random random(7);
  for (int k = 0; k < 2000; ++k) {
    const double r[3] = {random.uniform(1.001, 3), -random.uniform(0.001, 3), random.uniform(1.001, 3)};
    double c[4];
    expand(random.uniform(-5, 5), r, c);
    ASSERT_EQ(cubic_roots(c).count, 0);
  }
}

TEST(Cubic, ZeroAndNotFiniteAnswerWithEverything) {
  const double infinite = std::numeric_limits<double>::infinity();
  const double tiny = std::numeric_limits<double>::denorm_min();
  const double cases[][4] = {
      {0, 0, 0, 0}, {std::nan(""), 1, 1, 1}, {1, infinite, 1, 1}, {1, 1, 1, -infinite}};
  for (const auto& c : cases) {
    const CubicRoots found = cubic_roots(c);
    ASSERT_EQ(found.count, 1);
    EXPECT_EQ(found.interval[0].lo, 0);
    EXPECT_EQ(found.interval[0].hi, 1);
  }
  const double small[4] = {tiny, -2 * tiny, 0, 0};
  expect_all_roots(small, exact(small), 0);
  const double large[4] = {1e307, -4e307, 4e307, 0};
  expect_all_roots(large, exact(large), 0);
}

}  // namespace souple::test_collision_continuous
