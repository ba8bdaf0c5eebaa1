#pragma once

#include "souple/math/mat3.h"

namespace souple {

/// A rotation x i + y j + z k + w.
template <class T>
struct Quaternion {
  T x{}, y{}, z{}, w{T(1)};

  /// Rotation by `angle` radians about the unit vector `axis`.
  static Quaternion from_axis_angle(const Vec3<T>& axis, T angle) {
    const T s = sin(angle / T(2));
    return {axis.x * s, axis.y * s, axis.z * s, cos(angle / T(2))};
  }
  /// Rotations about X, then Y, then Z (fixed axes), in radians.
  static Quaternion from_euler_xyz(const Vec3<T>& angles) {
    return from_axis_angle({T(0), T(0), T(1)}, angles.z) * from_axis_angle({T(0), T(1), T(0)}, angles.y) *
           from_axis_angle({T(1), T(0), T(0)}, angles.x);
  }

  friend constexpr Quaternion operator*(const Quaternion& a, const Quaternion& b) {
    return {a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y, a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x,
            a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w, a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z};
  }
};

using Quatf = Quaternion<float>;
using Quatd = Quaternion<double>;

template <class T>
constexpr Quaternion<T> conjugate(const Quaternion<T>& q) {
  return {-q.x, -q.y, -q.z, q.w};
}

/// q / |q|, or the identity where |q| is zero.
template <class T>
Quaternion<T> normalized(const Quaternion<T>& q) {
  const T l = sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w);
  if (!(l > T(0))) return {};
  return {q.x / l, q.y / l, q.z / l, q.w / l};
}

/// v rotated by the unit quaternion q.
template <class T>
constexpr Vec3<T> rotate(const Quaternion<T>& q, const Vec3<T>& v) {
  const Vec3<T> u{q.x, q.y, q.z};
  const Vec3<T> t = cross(u, v) * T(2);
  return v + t * q.w + cross(u, t);
}

/// The rotation matrix of the unit quaternion q.
template <class T>
constexpr Mat3<T> rotation_matrix(const Quaternion<T>& q) {
  return {rotate(q, Vec3<T>{T(1), T(0), T(0)}), rotate(q, Vec3<T>{T(0), T(1), T(0)}),
          rotate(q, Vec3<T>{T(0), T(0), T(1)})};
}

}  // namespace souple
