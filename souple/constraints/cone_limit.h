#pragma once

#include "souple/constraints/constraint.h"

namespace souple {

/// Limits the swing of a ball joint at x1: keeps the segment x1 x2 within a cone about the direction of x0
/// x1.
///
///   u = x1 - x0,  v = x2 - x1,  angle = atan2(|u x v|, u . v) in [0, pi],  C = max_angle - angle >= 0  [rad]
///   n = u x v / |u x v|,  d angle/dv = n x v / |v|^2,  d angle/du = -n x u / |u|^2
///
/// Compliance alpha in rad^2/J. If the segment is folded straight back, all ways out are equivalent: n
/// is an arbitrary normal of u. If the segments are aligned or one has zero length, the gradient is zero.
struct ConeLimit {
  static constexpr const char* name = "cone_limit";
  static constexpr int arity = 3;
  static constexpr Sense sense = Sense::non_negative;

  template <class T>
  struct Params {
    T max_angle;  ///< rad, in [0, pi)
  };

  template <class T>
  static T evaluate(const Vec3<T> (&x)[3], const Params<T>& p, Vec3<T> (&gradient)[3]) {
    const Vec3<T> u = x[1] - x[0], v = x[2] - x[1];
    const Vec3<T> normal = cross(u, v);
    const T uu = dot(u, u), vv = dot(v, v), uv = dot(u, v), nn = dot(normal, normal);
    const auto turned = nn > T(1e-12f) * uu * vv;

    // u x axis, with the coordinate axis along which u is shortest.
    const T ax = abs(u.x), ay = abs(u.y), az = abs(u.z);
    const T least = min(ax, min(ay, az));
    const Vec3<T> axis{select(ax > least, T(0), T(1)), select(ay > least, T(0), T(1)),
                       select(az > least, T(0), T(1))};
    const Vec3<T> any = cross(u, axis);
    const T back = select(uv < T(0), T(1), T(0));
    const Vec3<T> n =
        normalized(Vec3<T>{select(turned, normal.x, any.x * back), select(turned, normal.y, any.y * back),
                           select(turned, normal.z, any.z * back)});

    const auto long_enough = min(uu, vv) > T(0);
    const T inverse_uu = select(long_enough, T(1) / select(long_enough, uu, T(1)), T(0));
    const T inverse_vv = select(long_enough, T(1) / select(long_enough, vv, T(1)), T(0));
    gradient[0] = cross(u, n) * inverse_uu;  // C falls as the angle grows
    gradient[2] = cross(v, n) * inverse_vv;
    gradient[1] = -(gradient[0] + gradient[2]);
    return p.max_angle - select(long_enough, atan2(sqrt(nn), uv), T(0));
  }
};

}  // namespace souple
