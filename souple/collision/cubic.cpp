#include "souple/collision/cubic.h"

#include <algorithm>
#include <cmath>
#include <limits>

// f(t) = c0 + c1 t + c2 t^2 + c3 t^3 is monotone between the zeros of f'. On a monotone piece two values show whether
// it has a root. A point with |f| > E separates the roots from all points on one side of it.
//
// Let eps = 2^-52, S = |c0| + |c1| + |c2| + |c3| and t in [0, 1]. Then E must cover these errors:
//     2002, eq. 5.3).
// (2) The zeros of f' are rounded, so a piece is only nearly monotone. The computed zeros are those of a
//     quadratic whose coefficients differ by at most 5 eps from those of f' (the discriminant's two terms and
//     root, one sum, one division). So where f' has the wrong sign on a piece, |f'| <= 5 eps (|c1| + 2 |c2| +
//     3 |c3|) <= 15 eps S: between a true zero and the adjacent rounded one, |f'| is at most its value at the
//     rounded one. If the discriminant is rounded to below zero, two close zeros are missed; then |f'| =
//     |discriminant / (3 c3)| between them. With the zeros in [0, 1] and hence |c2| <= 3 |c3| and |c1| <=
//     |c2| (1 + eps) this is at most 8 eps |c2|. Pieces are at most 1 long, so f reverses by
//     at most 15 eps S.
// The sum is 18 eps S; 64 is a safe bound. `error` is added to it.

namespace souple {
namespace {

struct Cubic {
  double c[4];
  double E;

  double operator()(double t) const { return ((c[3] * t + c[2]) * t + c[1]) * t + c[0]; }
  double derivative(double t) const { return (3 * c[3] * t + 2 * c[2]) * t + c[1]; }
  /// The sign of f; 0 if f may be zero.
  int sign(double value) const { return value > E ? 1 : (value < -E ? -1 : 0); }
};

/// Zeros of f' within (0, 1), ascending, by the formula without cancellation. Returns their number.
int critical_points(const Cubic& f, double (&t)[2]) {
  const double a = 3 * f.c[3], b = f.c[2], discriminant = b * b - a * f.c[1];
  if (!(discriminant > 0)) return 0;  // none, or an inflection: monotone
  const double q = -(b + std::copysign(std::sqrt(discriminant), b));
  int count = 0;
  for (const double zero : {q / a, f.c[1] / q}) {
    if (zero > 0 && zero < 1) t[count++] = zero;
  }
  if (count == 2 && t[1] < t[0]) std::swap(t[0], t[1]);
  return count;
}

/// Searches from `inside`, where f may be zero, towards `outside`, where it is not. Returns a point where f has the
/// sign of f(outside), at most twice as far from `inside` as necessary. Steps grow fourfold, then the last is halved
/// once. (Other nonzero signs do not suffice: at the edge of the interval where f may be zero, the next value may have
/// the opposite sign.)
double leave_zero(const Cubic& f, double inside, double outside) {
  const int sign = f.sign(f(outside));
  const double distance = outside - inside;
  for (double step = std::numeric_limits<double>::epsilon() / 2; step < std::abs(distance); step *= 4) {
    const double t = inside + std::copysign(step, distance);
    if (f.sign(f(t)) != sign) continue;
    const double half = inside + std::copysign(step / 2, distance);
    return f.sign(f(half)) == sign ? half : t;
  }
  return outside;
}

/// The interval of the single root between `lo` and `hi`, where f has opposite signs. Newton's method, with a bisection
/// in every fourth step, so that it ends for any f.
RootInterval bracket(const Cubic& f, double lo, double hi) {
  const int sign_lo = f.sign(f(lo));
  double t = 0.5 * (lo + hi);
  for (int k = 0; t > lo && t < hi; ++k) {
    const double value = f(t);
    const int sign = f.sign(value);
    if (sign == 0) return {leave_zero(f, t, lo), leave_zero(f, t, hi)};
    (sign == sign_lo ? lo : hi) = t;
    t -= value / f.derivative(t);
    if (!(t > lo && t < hi) || k % 4 == 3) t = 0.5 * (lo + hi);
  }
  return {lo, hi};
}

void add_piece(const Cubic& f, double u, double v, CubicRoots& roots) {
  const int sign_u = f.sign(f(u)), sign_v = f.sign(f(v));
  if (sign_u == sign_v && sign_u != 0) return;
  RootInterval found{u, v};
  if (sign_u != 0 && sign_v != 0) {
    found = bracket(f, u, v);
  } else if (sign_u != 0) {
    found.lo = leave_zero(f, v, u);
  } else if (sign_v != 0) {
    found.hi = leave_zero(f, u, v);
  }
  if (roots.count > 0 && roots.interval[roots.count - 1].hi >= found.lo) {
    roots.interval[roots.count - 1].hi = found.hi;
  } else {
    roots.interval[roots.count++] = found;
  }
}

}  // namespace

CubicRoots cubic_roots(const double (&c)[4], double error) {
  const double sum = std::abs(c[0]) + std::abs(c[1]) + std::abs(c[2]) + std::abs(c[3]);
  CubicRoots roots;
  if (!(sum > 0 && sum <= std::numeric_limits<double>::max() && error >= 0)) {
    roots.count = 1;
    roots.interval[0] = {0, 1};
    return roots;
  }
  // Scale such that squares neither overflow nor vanish. A power of two adds no rounding that E does not
  // cover.
  const int exponent = std::ilogb(sum);
  const double scale = std::abs(exponent) > 300 ? std::ldexp(1.0, std::clamp(-exponent, -1000, 1000)) : 1;
  const Cubic f{{c[0] * scale, c[1] * scale, c[2] * scale, c[3] * scale},
                error * scale + 64 * std::numeric_limits<double>::epsilon() * (sum * scale)};

  double breakpoints[4] = {0, 1, 1, 1};
  double critical[2];
  const int critical_count = critical_points(f, critical);
  for (int k = 0; k < critical_count; ++k) breakpoints[k + 1] = critical[k];
  for (int k = 0; k <= critical_count; ++k) add_piece(f, breakpoints[k], breakpoints[k + 1], roots);
  return roots;
}

}  // namespace souple
