#pragma once

#include "souple/constraints/constraint.h"

#include <limits>

namespace souple {

/// Keeps two particles at their rest distance l. C = |x0 - x1| - l  [m].  Müller et al. 2007, eq. 10.
/// Energy 1/2 k C^2 with k [N/m]; compliance alpha = 1/k [m/N]. For coincident particles the direction is
/// undefined and the gradient is zero.
struct Distance {
  static constexpr const char* name = "distance";
  static constexpr int arity = 2;
  static constexpr Sense sense = Sense::equality;
  static constexpr bool unit_gradients = true;

  template <class T>
  struct Params {
    T rest_length;  ///< m
  };

  template <class T>
  static T evaluate(const Vec3<T> (&x)[2], const Params<T>& p, Vec3<T> (&gradient)[2]) {
    const Vec3<T> d = x[0] - x[1];
    const T l = sqrt(dot(d, d));
    const Vec3<T> n = d * (T(1) / max(l, T(1e-18f)));  // below 1e-18, dot(d, d) has no digits left
    gradient[0] = n;
    gradient[1] = -n;
    return l - p.rest_length;
  }

  static float rest_length(const Params<float>& p) { return p.rest_length; }

  /// Extension (l - l0) / l0 of a constraint whose value is C; 0 where the rest length is 0.
  static float strain(const Params<float>& p, const float (&C)[1]) {
    // A selection instead of a branch around the division, so that it vectorizes.
    return C[0] / (p.rest_length > 0 ? p.rest_length : std::numeric_limits<float>::infinity());
  }
};

}  // namespace souple
