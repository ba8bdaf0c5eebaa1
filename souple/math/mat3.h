#pragma once

#include "souple/math/vec3.h"

namespace souple {

/// A 3 x 3 matrix of any scalar type, stored as three columns.
template <class T>
struct Mat3 {
  Vec3<T> column[3];

  constexpr Mat3() = default;
  constexpr Mat3(const Vec3<T>& c0, const Vec3<T>& c1, const Vec3<T>& c2) : column{c0, c1, c2} {}
  template <class U>
  constexpr explicit Mat3(const Mat3<U>& m)
      : column{Vec3<T>(m.column[0]), Vec3<T>(m.column[1]), Vec3<T>(m.column[2])} {}

  static constexpr Mat3 identity() { return diagonal({T(1), T(1), T(1)}); }
  static constexpr Mat3 diagonal(const Vec3<T>& d) {
    return {{d.x, T(0), T(0)}, {T(0), d.y, T(0)}, {T(0), T(0), d.z}};
  }

  constexpr T& operator()(int row, int col) { return column[col][row]; }
  constexpr const T& operator()(int row, int col) const { return column[col][row]; }

  friend constexpr Mat3 operator+(const Mat3& a, const Mat3& b) {
    return {a.column[0] + b.column[0], a.column[1] + b.column[1], a.column[2] + b.column[2]};
  }
  friend constexpr Mat3 operator-(const Mat3& a, const Mat3& b) {
    return {a.column[0] - b.column[0], a.column[1] - b.column[1], a.column[2] - b.column[2]};
  }
  friend constexpr Mat3 operator*(const Mat3& a, T s) {
    return {a.column[0] * s, a.column[1] * s, a.column[2] * s};
  }
  friend constexpr Vec3<T> operator*(const Mat3& a, const Vec3<T>& v) {
    return a.column[0] * v.x + a.column[1] * v.y + a.column[2] * v.z;
  }
  friend constexpr Mat3 operator*(const Mat3& a, const Mat3& b) {
    return {a * b.column[0], a * b.column[1], a * b.column[2]};
  }
};

using Mat3f = Mat3<float>;
using Mat3d = Mat3<double>;

template <class T>
constexpr Mat3<T> transpose(const Mat3<T>& m) {
  return {{m.column[0].x, m.column[1].x, m.column[2].x},
          {m.column[0].y, m.column[1].y, m.column[2].y},
          {m.column[0].z, m.column[1].z, m.column[2].z}};
}

/// The matrix of cofactors, d(det m)/dm. Its columns are c1 x c2, c2 x c0, c0 x c1.
template <class T>
constexpr Mat3<T> cofactor(const Mat3<T>& m) {
  return {cross(m.column[1], m.column[2]), cross(m.column[2], m.column[0]), cross(m.column[0], m.column[1])};
}

template <class T>
constexpr T determinant(const Mat3<T>& m) {
  return dot(m.column[0], cross(m.column[1], m.column[2]));
}

template <class T>
constexpr T trace(const Mat3<T>& m) {
  return m.column[0].x + m.column[1].y + m.column[2].z;
}

/// m^-1 = cofactor(m)^T / det m. Not finite when m is singular: the caller must check.
template <class T>
constexpr Mat3<T> inverse(const Mat3<T>& m) {
  return transpose(cofactor(m)) * (T(1) / determinant(m));
}

/// a b^T.
template <class T>
constexpr Mat3<T> outer(const Vec3<T>& a, const Vec3<T>& b) {
  return {a * b.x, a * b.y, a * b.z};
}

/// Sum of the squares of all entries.
template <class T>
constexpr T frobenius_squared(const Mat3<T>& m) {
  return dot(m.column[0], m.column[0]) + dot(m.column[1], m.column[1]) + dot(m.column[2], m.column[2]);
}

}  // namespace souple
