#pragma once

#include "souple/math/vec3.h"

#include <limits>

namespace souple {

/// An axis-aligned box: all points between two corners, which belong to it [m].
struct Bounds {
  Vec3f lo, hi;
};

/// The box without points: united with another one it gives that one.
inline constexpr Bounds empty_bounds{
    {std::numeric_limits<float>::infinity(), std::numeric_limits<float>::infinity(),
     std::numeric_limits<float>::infinity()},
    {-std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity(),
     -std::numeric_limits<float>::infinity()}};

/// Whether the box is valid: all numbers finite, lo <= hi.
inline bool is_finite(const Bounds& box) {
  return box.lo.x <= box.hi.x && box.lo.y <= box.hi.y && box.lo.z <= box.hi.z && is_finite(box.lo) &&
         is_finite(box.hi);
}

/// The smallest box around both.
inline Bounds united(const Bounds& a, const Bounds& b) {
  return {{min(a.lo.x, b.lo.x), min(a.lo.y, b.lo.y), min(a.lo.z, b.lo.z)},
          {max(a.hi.x, b.hi.x), max(a.hi.y, b.hi.y), max(a.hi.z, b.hi.z)}};
}

/// The smallest box around two points, widened by a margin [m].
inline Bounds around(const Vec3f& a, const Vec3f& b, float margin) {
  return {{min(a.x, b.x) - margin, min(a.y, b.y) - margin, min(a.z, b.z) - margin},
          {max(a.x, b.x) + margin, max(a.y, b.y) + margin, max(a.z, b.z) + margin}};
}

/// A box grown by a distance to all sides [m].
inline Bounds widened(const Bounds& box, float by) {
  const Vec3f all{by, by, by};
  return {box.lo - all, box.hi + all};
}

/// Whether the boxes share a point.
inline bool overlap(const Bounds& a, const Bounds& b) {
  return a.lo.x <= b.hi.x && b.lo.x <= a.hi.x && a.lo.y <= b.hi.y && b.lo.y <= a.hi.y && a.lo.z <= b.hi.z &&
         b.lo.z <= a.hi.z;
}

}  // namespace souple
