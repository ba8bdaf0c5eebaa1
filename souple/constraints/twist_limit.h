#pragma once

#include "souple/constraints/constraint.h"
#include "souple/constraints/dihedral_angle.h"
#include "souple/math/elementary.h"

namespace souple {

/// Limits the twist of a joint: two side particles rotate about the axis x0 x1 by at most `max_angle` from
/// their rest angle. x2 belongs to the body at x0, x3 to the body at x1. For a joint at b between the segments a b and
/// b c, use the axis a c. The twist about the mean of both directions does not depend on the swing.
///
///   C = max_angle - |theta - theta0| >= 0  [rad], theta as in dihedral_angle.h,  theta - theta0 in (-pi, pi]
///
/// Compliance alpha in rad^2/J. If a side particle is on the axis, the angle is undefined. C is then that of an
/// untwisted joint, and the gradient is zero.
struct TwistLimit {
  static constexpr const char* name = "twist_limit";
  static constexpr int arity = 4;
  static constexpr Sense sense = Sense::non_negative;

  template <class T>
  struct Params {
    T rest_sine, rest_cosine;  ///< of theta0
    T max_angle;               ///< rad, in [0, pi)
  };

  /// The current angle becomes the rest angle.
  static Params<float> from_rest(const Vec3d (&x)[4], double max_angle) {
    const DihedralAngle<double> angle = dihedral_angle(x);
    const double norm = elementary::hypot(angle.sine, angle.cosine);
    if (!(norm > 0)) return {0, 1, static_cast<float>(max_angle)};
    return {static_cast<float>(angle.sine / norm), static_cast<float>(angle.cosine / norm),
            static_cast<float>(max_angle)};
  }

  template <class T>
  static T evaluate(const Vec3<T> (&x)[4], const Params<T>& p, Vec3<T> (&gradient)[4]) {
    const DihedralAngle<T> angle = dihedral_angle(x);
    const T twist = atan2(angle.sine * p.rest_cosine - angle.cosine * p.rest_sine,
                          angle.cosine * p.rest_cosine + angle.sine * p.rest_sine);
    const T sign = select(twist > T(0), T(-1), T(1));
    for (int i = 0; i < 4; ++i) gradient[i] = angle.gradient[i] * sign;
    return p.max_angle - abs(twist);
  }
};

}  // namespace souple
