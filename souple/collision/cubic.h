#pragma once

namespace souple {

/// lo <= root <= hi.
struct RootInterval {
  double lo = 0, hi = 0;
};

/// Up to three intervals within [0, 1], apart and in ascending order.
struct CubicRoots {
  int count = 0;
  RootInterval interval[3];
};

/// Where c[0] + c[1] t + c[2] t^2 + c[3] t^3 may be zero in [0, 1]. Every t of [0, 1] at which the exact
/// value is within `error` of zero lies in one of the intervals: no root is missed, double and triple ones
/// neither, and with `error` >= 0 a bound of what the coefficients themselves are wrong by, none of the true
/// polynomial. The zero polynomial, and coefficients that are not finite, answer with [0, 1].
///
/// A simple root's interval is about (error + 64 eps sum |c|) / |f'| wide on either side, a double root's is
/// the square root of such a number.
CubicRoots cubic_roots(const double (&c)[4], double error = 0);

}  // namespace souple
