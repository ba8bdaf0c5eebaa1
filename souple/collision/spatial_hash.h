#pragma once

#include "souple/math/vec3.h"
#include "souple/solver/threads.h"

#include <cstdint>
#include <span>
#include <vector>

namespace souple {

/// All points between two corners, these included [m].
struct Box {
  Vec3f lo, hi;
};

inline bool overlap(const Box& a, const Box& b) {
  return a.lo.x <= b.hi.x && b.lo.x <= a.hi.x && a.lo.y <= b.hi.y && b.lo.y <= a.hi.y && a.lo.z <= b.hi.z &&
         b.lo.z <= a.hi.z;
}

/// The smallest box around both.
inline Box united(const Box& a, const Box& b) {
  return {{min(a.lo.x, b.lo.x), min(a.lo.y, b.lo.y), min(a.lo.z, b.lo.z)},
          {max(a.hi.x, b.hi.x), max(a.hi.y, b.hi.y), max(a.hi.z, b.hi.z)}};
}

}  // namespace souple
