#pragma once

#include "souple/constraints/constraint.h"
#include "souple/constraints/rest_shape.h"
#include "souple/math/elementary.h"

#include <array>

namespace souple {

/// Keeps the signed volume of a tetrahedron. C = V - V0  [m^3],
///   V = 1/6 (x1 - x0) . (x2 - x0) x (x3 - x0),   grad_1 V = 1/6 (x2 - x0) x (x3 - x0)  and so on.
/// Müller et al. 2007, section 4.4, for one tet. Energy K/2 V0 (C/V0)^2 with the bulk modulus K [Pa];
/// compliance alpha = V0/K [m^6/J]. For collinear particles the gradient is zero, and no particle moves.
struct TetVolume {
  static constexpr const char* name = "tet_volume";
  static constexpr int arity = 4;
  static constexpr Sense sense = Sense::equality;

  template <class T>
  struct Params {
    T rest_volume;  ///< V0 [m^3]
    T rest_size;    ///< cube root of V0: longest correction of one projection [m]
  };

  /// Throws Error when the tet is flat or inverted.
  static Params<float> from_rest(const Vec3d (&x)[4]) {
    const double volume = dot(x[1] - x[0], cross(x[2] - x[0], x[3] - x[0])) / 6;
    const double edge = detail::longest_edge(x);
    detail::require_valid_rest_shape(volume, 0.1 * edge * edge * edge, name);
    return {static_cast<float>(volume), static_cast<float>(elementary::cbrt(volume))};
  }

  static std::array<float, 1> compliance(double bulk_modulus, double rest_volume) {
    detail::require_positive(bulk_modulus, "bulk modulus [Pa]");
    return {static_cast<float>(rest_volume / bulk_modulus)};
  }

  template <class T>
  static T max_correction(const Params<T>& p) {
    return p.rest_size;
  }

  template <class T>
  static T evaluate(const Vec3<T> (&x)[4], const Params<T>& p, Vec3<T> (&gradient)[4]) {
    const Vec3<T> e1 = x[1] - x[0], e2 = x[2] - x[0], e3 = x[3] - x[0];
    const T sixth = T(1) / T(6);
    gradient[1] = cross(e2, e3) * sixth;
    gradient[2] = cross(e3, e1) * sixth;
    gradient[3] = cross(e1, e2) * sixth;
    gradient[0] = -(gradient[1] + gradient[2] + gradient[3]);
    return dot(e1, gradient[1]) - p.rest_volume;
  }
};

}  // namespace souple
