#pragma once

#include "souple/constraints/constraint.h"

namespace souple {

/// Keeps two spheres from overlapping. C = |x0 - x1| - (r0 + r1) >= 0  [m].  The sphere inequality of the
/// seed; Müller et al. 2007, section 4.3. Coincident centers are separated along Y: any direction is valid, a
/// zero gradient would not be.
struct ParticleContact {
  static constexpr const char* name = "particle_contact";
  static constexpr int arity = 2;
  static constexpr Sense sense = Sense::non_negative;
  static constexpr bool unit_gradients = true;

  template <class T>
  struct Params {
    T distance;  ///< r0 + r1 [m]
  };

  template <class T>
  static T evaluate(const Vec3<T> (&x)[2], const Params<T>& p, Vec3<T> (&gradient)[2]) {
    const Vec3<T> d = x[0] - x[1];
    const T l = sqrt(dot(d, d));
    const T inverse_l = select(l > T(0), T(1) / select(l > T(0), l, T(1)), T(0));
    gradient[0] = {d.x * inverse_l, select(l > T(0), d.y * inverse_l, T(1)), d.z * inverse_l};
    gradient[1] = -gradient[0];
    return l - p.distance;
  }
};

}  // namespace souple
