#pragma once

// Scalar functions for kernels. Constraints and small linear algebra are written once for a type T: float,
// double, a dual number or a SIMD pack. T provides the four arithmetic operators and comparisons whose result `select`
// takes. It also provides the functions below, found by argument-dependent lookup for types that are not built in.

#include "souple/math/elementary.h"

#include <cmath>

namespace souple {

using std::abs;
using std::acos;
using std::cos;
using std::sin;
using std::sqrt;

// Like std::min and std::max, without <algorithm>: almost every file includes this one.
template <class T>
constexpr const T& min(const T& a, const T& b) {
  return b < a ? b : a;
}
template <class T>
constexpr const T& max(const T& a, const T& b) {
  return a < b ? b : a;
}

/// `condition ? a : b`, lane by lane for packs.
inline float select(bool condition, float a, float b) {
  return condition ? a : b;
}
inline double select(bool condition, double a, double b) {
  return condition ? a : b;
}

/// Whether the condition holds in any lane.
inline bool any_lane(bool condition) {
  return condition;
}

/// atan2(y, x) in [-pi, pi], with an error below 3e-7 rad; 0 at (0, 0). T = float and packs of floats give
/// the same bits.
///
/// With t = min(|x|, |y|) / max(|x|, |y|) in [0, 1], reduced to u = (t - 1) / (t + 1) above tan(pi/8):
///   atan(u) = u + u^3 P(u^2), P the minimax polynomial of Cephes' atanf (Moshier 1989).
template <class T>
T arctangent(T y, T x) {
  const T one(1.0f), zero(0.0f);
  const T ax = select(x < zero, -x, x), ay = select(y < zero, -y, y);
  const auto steep = ay > ax;
  const T larger = select(steep, ay, ax), smaller = select(steep, ax, ay);
  const auto anywhere = larger > zero;
  const T t = select(anywhere, smaller / select(anywhere, larger, one), zero);

  const auto reduce = t > T(0.41421356f);
  const T u = select(reduce, (t - one) / (t + one), t);
  const T z = u * u;
  const T P = ((T(8.05374449538e-2f) * z - T(1.38776856032e-1f)) * z + T(1.99777106478e-1f)) * z -
              T(3.33329491539e-1f);
  T angle = u + u * z * P;
  angle = select(reduce, T(0.785398163f) + angle, angle);
  angle = select(steep, T(1.57079633f) - angle, angle);
  angle = select(x < zero, T(3.14159265f) - angle, angle);
  return select(y < zero, -angle, angle);
}

inline double atan2(double y, double x) {
  return elementary::atan2(y, x);
}
/// By arithmetic alone, so that packs give the same bits: the C library's result differs between versions.
inline float atan2(float y, float x) {
  return arctangent(y, x);
}

/// The plain number of a scalar: itself for float and double, the value of a dual number.
inline float value_of(float a) {
  return a;
}
inline double value_of(double a) {
  return a;
}

inline constexpr double pi = 3.14159265358979323846;

}  // namespace souple
