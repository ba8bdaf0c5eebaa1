#pragma once

#include "souple/math/vec3.h"

namespace souple {

/// A point of a triangle a, b, c as barycentric weights, which sum to 1.
struct TrianglePoint {
  double a = 0, b = 0, c = 0;
};

/// The point of triangle a, b, c nearest to p. Ericson, Real-Time Collision Detection (2005), section 5.1.5.
/// For a triangle without area it returns some point of the triangle.
inline TrianglePoint closest_on_triangle(const Vec3d& p, const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const Vec3d ab = b - a, ac = c - a, ap = p - a;
  const double d1 = dot(ab, ap), d2 = dot(ac, ap);
  if (d1 <= 0 && d2 <= 0) return {1, 0, 0};
  const Vec3d bp = p - b;
  const double d3 = dot(ab, bp), d4 = dot(ac, bp);
  if (d3 >= 0 && d4 <= d3) return {0, 1, 0};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0 && d1 > d3) {
    const double t = d1 / (d1 - d3);
    return {1 - t, t, 0};
  }
  const Vec3d cp = p - c;
  const double d5 = dot(ab, cp), d6 = dot(ac, cp);
  if (d6 >= 0 && d5 <= d6) return {0, 0, 1};
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0 && d2 > d6) {
    const double t = d2 / (d2 - d6);
    return {1 - t, 0, t};
  }
  const double va = d3 * d6 - d5 * d4;
  const double along = d4 - d3, back = d5 - d6;
  if (va <= 0 && along >= 0 && back >= 0 && along + back > 0) {
    const double t = along / (along + back);
    return {0, 1 - t, t};
  }
  const double sum = va + vb + vc;
  return sum > 0 ? TrianglePoint{va / sum, vb / sum, vc / sum} : TrianglePoint{1, 0, 0};
}

}  // namespace souple
