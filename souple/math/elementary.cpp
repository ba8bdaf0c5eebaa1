#include "souple/math/elementary.h"

#include "souple/math/scalar.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace souple::elementary {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// x = turns pi / 2 + rest, |rest| <= pi / 4 but for rounding.
struct Reduced {
  int quadrant;  // turns modulo 4
  double rest;
};

// The three parts of pi / 2 have 33, 33 and 53 bits: the products with turns < 2^20 of the first two are exact (Cody and
// Waite 1980).
Reduced reduce(double x) {
  if (std::abs(x) > 1048576.0) x = std::remainder(x, 2 * pi);
  const double turns = std::floor(x * (2 / pi) + 0.5);
  const double rest =
      ((x - turns * 0x1.921fb544p+0) - turns * 0x1.0b4611a6p-34) - turns * 0x1.3198a2e037073p-69;
  return {static_cast<int>(turns - 4 * std::floor(turns / 4)), rest};
}

// Taylor series: the first term left out is below 3e-18 of the result for |x| <= pi / 4.
//   sin(x) = x - x^3 / 3! + ... + x^17 / 17!,  cos(x) = 1 - x^2 / 2! + ... + x^16 / 16!
double sine_series(double x) {
  const double z = x * x;
  double sum = 1.0 / 355687428096000;
  for (const double term : {-1.0 / 1307674368000, 1.0 / 6227020800, -1.0 / 39916800, 1.0 / 362880,
                            -1.0 / 5040, 1.0 / 120, -1.0 / 6})
    sum = term + z * sum;
  return x + x * (z * sum);
}

double cosine_series(double x) {
  const double z = x * x;
  double sum = 1.0 / 20922789888000;
  for (const double term :
       {-1.0 / 87178291200, 1.0 / 479001600, -1.0 / 3628800, 1.0 / 40320, -1.0 / 720, 1.0 / 24})
    sum = term + z * sum;
  // 1 - z / 2 with its rounding error, which the rest of the series takes
  const double half = 0.5 * z, leading = 1 - half;
  return leading + (((1 - leading) - half) + z * z * sum);
}

// arctan(x) in [0, 1]: with c the nearest multiple of 1/8, arctan(x) = arctan(c) + arctan((x - c) / (1 + x c)), whose
// argument is at most 1/16.
double arctangent_of_fraction(double y, double x) {  // 0 <= y <= x, x > 0
  constexpr double of_eighths[] = {0,
                                   0x1.fd5ba9aac2f6ep-4,
                                   0x1.f5b75f92c80ddp-3,
                                   0x1.6f61941e4def1p-2,
                                   0x1.dac670561bb4fp-2,
                                   0x1.1e00babdefeb4p-1,
                                   0x1.4978fa3269ee1p-1,
                                   0x1.700a7c5784634p-1,
                                   0x1.921fb54442d18p-1};
  const auto nearest = static_cast<int>(std::lround(8 * (y / x)));
  const double c = 0.125 * nearest;
  const double t = nearest == 0 ? y / x : (y - c * x) / (x + c * y);
  const double z = t * t;
  double sum = 1.0 / 13;  // sum of (-1)^k t^(2 k + 1) / (2 k + 1)
  for (const double term : {-1.0 / 11, 1.0 / 9, -1.0 / 7, 1.0 / 5, -1.0 / 3}) sum = term + z * sum;
  return of_eighths[nearest] + (t + t * (z * sum));
}

}  // namespace

double sin(double x) {
  if (!std::isfinite(x)) return nan;
  const auto [quadrant, rest] = reduce(x);
  const double value = quadrant % 2 == 0 ? sine_series(rest) : cosine_series(rest);
  return quadrant < 2 ? value : -value;
}

double cos(double x) {
  if (!std::isfinite(x)) return nan;
  const auto [quadrant, rest] = reduce(x);
  const double value = quadrant % 2 == 0 ? cosine_series(rest) : sine_series(rest);
  return quadrant == 0 || quadrant == 3 ? value : -value;
}

double atan2(double y, double x) {
  if (std::isnan(x) || std::isnan(y)) return nan;
  double across = std::abs(x), up = std::abs(y);
  if (across == infinity && up == infinity) across = up = 1;
  double angle = 0;
  if (up > across) {
    angle = pi / 2 - arctangent_of_fraction(across, up);
  } else if (across > 0) {
    angle = arctangent_of_fraction(up, across);
  }
  if (x < 0) angle = pi - angle;
  return std::copysign(angle, y);
}

double asin(double x) {
  return atan2(x, std::sqrt((1 - x) * (1 + x)));
}

double acos(double x) {
  return atan2(std::sqrt((1 - x) * (1 + x)), x);
}

// x = n ln 2 + r, |r| <= ln(2) / 2: exp(x) = 2^n exp(r), by its Taylor series. The first part of ln 2 has 32 bits: its
// product with n is exact.
double exp(double x) {
  if (std::isnan(x)) return nan;
  if (x > 710) return infinity;
  if (x < -750) return 0;
  const double n = std::floor(x * 1.4426950408889634 + 0.5);
  const double r = (x - n * 0x1.62e42feep-1) - n * 0x1.a39ef35793c76p-33;
  double sum = 1.0 / 6227020800;
  for (const double term : {1.0 / 479001600, 1.0 / 39916800, 1.0 / 3628800, 1.0 / 362880, 1.0 / 40320,
                            1.0 / 5040, 1.0 / 720, 1.0 / 120, 1.0 / 24, 1.0 / 6, 1.0 / 2})
    sum = term + r * sum;
  return std::ldexp(1 + (r + r * r * sum), static_cast<int>(n));
}

// x = 2^n m, m in [sqrt(1/2), sqrt(2)): with s = (m - 1) / (m + 1), log(m) = 2 (s + s^3 / 3 + s^5 / 5 + ...)
double log(double x) {
  if (x == 0) return -infinity;
  if (!(x > 0)) return nan;
  if (x == infinity) return infinity;
  int n = 0;
  double m = std::frexp(x, &n);
  if (m < 0.7071067811865476) {
    m *= 2;
    --n;
  }
  const double f = m - 1, s = f / (m + 1), z = s * s;
  double sum = 1.0 / 23;
  for (const double odd : {21.0, 19.0, 17.0, 15.0, 13.0, 11.0, 9.0, 7.0, 5.0, 3.0}) sum = 1 / odd + z * sum;
  // 2 s = f - s f: f has no rounding error
  const double rest = s * (2 * z * sum - f);
  return n * 0x1.62e42feep-1 + (f + (rest + n * 0x1.a39ef35793c76p-33));
}

double pow(double x, double y) {
  if (y == 0) return 1;
  if (x == 0) return y > 0 ? 0 : infinity;
  return exp(y * log(x));
}

// |x| = 8^n m, m in [1/8, 1): Newton's method for t^3 = m from a straight line, whose error of 7 % four steps square.
double cbrt(double x) {
  if (x == 0 || !std::isfinite(x)) return x;
  int exponent = 0;
  double m = std::frexp(std::abs(x), &exponent);
  for (; exponent % 3 != 0; ++exponent) m *= 0.5;
  double t = 0.45 + 0.58 * m;
  for (int step = 0; step < 5; ++step) t -= (t * t * t - m) / (3 * t * t);
  return std::copysign(std::ldexp(t, exponent / 3), x);
}

double hypot(double x, double y) {
  const double larger = std::max(std::abs(x), std::abs(y)), smaller = std::min(std::abs(x), std::abs(y));
  if (!(larger > 0) || larger == infinity) return larger;
  const double ratio = smaller / larger;
  return larger * std::sqrt(1 + ratio * ratio);
}

}  // namespace souple::elementary
