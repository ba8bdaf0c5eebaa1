#include "souple/collision/cubic.h"
#include "tests/collision/exact_cubic.h"
#include "tests/collision/random.h"

#include <cmath>
#include <cstdlib>
#include <limits>

#include <gtest/gtest.h>

namespace souple::test_collision_cubic {

using test::Polynomial;
using test::Random;
using test::Rational;
using test::RootCounter;

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

}  // namespace souple::test_collision_cubic
