#pragma once

#include "souple/math/vec3.h"

#include <gmpxx.h>

// Arithmetic without rounding, for predicates whose answer must be known for sure: dot, cross and the rest of
// Vec3 work on it. Slow: ask it only what numbers with bounds leave open.

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
