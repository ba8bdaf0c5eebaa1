#pragma once

#include "souple/math/elementary.h"
#include "souple/math/mat3.h"

namespace souple {

/// A rotation x i + y j + z k + w.
template <class T>
struct Quaternion {
  T x{}, y{}, z{}, w{T(1)};

  /// Rotation by `angle` radians about the unit vector `axis`.
  static Quaternion from_axis_angle(const Vec3<T>& axis, T angle) {
    const double half = static_cast<double>(angle) / 2;
    const T s = static_cast<T>(elementary::sin(half));
    return {axis.x * s, axis.y * s, axis.z * s, static_cast<T>(elementary::cos(half))};
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

/// The unit quaternion of a rotation matrix, from its largest component to avoid division by almost zero
/// (Shepperd 1978).
template <class T>
Quaternion<T> quaternion_of(const Mat3<T>& m) {
  const T x = m(0, 0), y = m(1, 1), z = m(2, 2), w = x + y + z;
  const T a = m(2, 1) - m(1, 2), b = m(0, 2) - m(2, 0), c = m(1, 0) - m(0, 1);
  const T xy = m(0, 1) + m(1, 0), xz = m(0, 2) + m(2, 0), yz = m(1, 2) + m(2, 1);
  const T largest = max(max(x, y), max(z, w));
  if (largest == w) return normalized(Quaternion<T>{a, b, c, T(1) + w});
  if (largest == x) return normalized(Quaternion<T>{T(1) + x - y - z, xy, xz, a});
  if (largest == y) return normalized(Quaternion<T>{xy, T(1) + y - x - z, yz, b});
  return normalized(Quaternion<T>{xz, yz, T(1) + z - x - y, c});
}

}  // namespace souple
