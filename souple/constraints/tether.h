#pragma once

#include "souple/constraints/constraint.h"

namespace souple {

/// Long-range attachment: keeps particle 0 within a distance L of the anchor, particle 1, however much the
/// cloth or rope between them stretches. C = L - |x0 - x1| >= 0  [m].  Kim, Chentanez and Müller-Fischer
/// 2012, section 3. Coincident particles are far from the limit; their direction is undefined and the
/// gradient zero.
struct Tether {
  static constexpr const char* name = "tether";
  static constexpr int arity = 2;
  static constexpr Sense sense = Sense::non_negative;
  static constexpr bool unit_gradients = true;

  template <class T>
  struct Params {
    T max_length;  ///< L, the rest distance along the material or in a straight line [m]
  };

  /// L is the straight rest distance times `slack`; 1: no slack.
  static Params<float> from_rest(const Vec3d (&x)[2], double slack = 1) {
    return {static_cast<float>(slack * length(x[0] - x[1]))};
  }

  template <class T>
  static T evaluate(const Vec3<T> (&x)[2], const Params<T>& p, Vec3<T> (&gradient)[2]) {
    const Vec3<T> d = x[1] - x[0];
    const T l = sqrt(dot(d, d));
    gradient[0] = d * (T(1) / max(l, T(1e-18f)));
    gradient[1] = -gradient[0];
    return p.max_length - l;
  }
};

}  // namespace souple
