#pragma once

#include "souple/math/vec3.h"

#include <gmpxx.h>

// Arithmetic without rounding, for predicates whose result must be certain: dot, cross and other functions of
// Vec3 accept it. It is slow: use it only where numbers with error bounds are not sufficient.

namespace souple::test {

using Exact = mpq_class;

/// Every finite float or double is a fraction.
template <class T>
Vec3<Exact> exact(const Vec3<T>& v) {
  return {Exact(static_cast<double>(v.x)), Exact(static_cast<double>(v.y)), Exact(static_cast<double>(v.z))};
}

/// a . (b x c)
inline Exact exact_volume(const Vec3<Exact>& a, const Vec3<Exact>& b, const Vec3<Exact>& c) {
  return dot(a, cross(b, c));
}

}  // namespace souple::test
