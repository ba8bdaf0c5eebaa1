#pragma once

#include "souple/constraints/constraint.h"

#include <array>

namespace souple {

/// Straightens three consecutive particles of a rope. C = |x0 - 2 x1 + x2|  [m]; for segments of length l
/// that is curvature times l^2. Energy 1/2 E I kappa^2 l = 1/2 (E I / l^3) C^2, E I in N m^2; compliance
/// alpha = l^3 / (E I) [m/N]. When straight, C is 0 and the direction undefined: C and gradient are zero
/// while the sum is below the rounding of its terms.
struct RopeBending {
  static constexpr const char* name = "rope_bending";
  static constexpr int arity = 3;
  static constexpr Sense sense = Sense::equality;

  template <class T>
  struct Params {
    T rest_length;  ///< l, rest length of one segment [m]
  };

  static std::array<float, 3> flat_gradient(const Params<float>&) { return {1, -2, 1}; }

  template <class T>
  static T evaluate(const Vec3<T> (&x)[3], const Params<T>& p, Vec3<T> (&gradient)[3]) {
    const Vec3<T> k = (x[0] - x[1]) + (x[2] - x[1]);
    const T kk = dot(k, k);
    const auto bent = kk > T(1e-13f) * p.rest_length * p.rest_length;
    const T c = sqrt(select(bent, kk, T(1)));
    const Vec3<T> n = k * select(bent, T(1) / c, T(0));
    gradient[0] = n;
    gradient[1] = n * T(-2);
    gradient[2] = n;
    return select(bent, c, T(0));
  }
};

}  // namespace souple
