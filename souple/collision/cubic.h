#pragma once

namespace souple {

/// lo <= root <= hi.
struct RootInterval {
  double lo = 0, hi = 0;
};

/// Up to three disjoint intervals within [0, 1], in ascending order.
struct CubicRoots {
  int count = 0;
  RootInterval interval[3];
};

/// Where c[0] + c[1] t + c[2] t^2 + c[3] t^3 may be zero in [0, 1]. Every t in [0, 1] whose exact value is
/// within `error` of zero lies in one of the intervals. So no root is missed, including double and triple
/// roots. With `error` >= 0 a bound of the errors of the coefficients themselves, no root of the true
/// polynomial is missed. For the zero polynomial, and for coefficients that are not finite, the result is [0,
/// 1].
///
/// The interval of a simple root extends about (error + 64 eps sum |c|) / |f'| to either side. For a double root it is
/// about the square root of such a number.
CubicRoots cubic_roots(const double (&c)[4], double error = 0);

}  // namespace souple
