#pragma once

// The scalar vocabulary of the kernels. Constraints and small linear algebra are written once on a type T:
// float, double, a dual number or a SIMD pack. A T brings the four operators, comparisons whose result
// `select` takes, and these functions, found by argument-dependent lookup for types that are not built in.

#include <algorithm>
#include <cmath>

namespace souple {

using std::abs;
using std::acos;
using std::atan2;
using std::cos;
using std::max;
using std::min;
using std::sin;
using std::sqrt;

/// `condition ? a : b`, lane by lane for packs.
inline float select(bool condition, float a, float b) {
  return condition ? a : b;
}
inline double select(bool condition, double a, double b) {
  return condition ? a : b;
}

/// The plain number behind a scalar: itself for float and double, the value part of a dual number.
inline float value_of(float a) {
  return a;
}
inline double value_of(double a) {
  return a;
}

inline constexpr double pi = 3.14159265358979323846;

}  // namespace souple
