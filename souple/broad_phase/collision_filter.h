#pragma once

#include <cstdint>

namespace souple {

/// Collision groups of an object or a collider, one bit for each of 32.
struct CollisionFilter {
  std::uint32_t groups = 1;  ///< those that it belongs to
  std::uint32_t mask = ~0u;  ///< those that it collides with
  bool operator==(const CollisionFilter&) const = default;
};

/// True when each side belongs to a group in the mask of the other side.
inline bool may_collide(const CollisionFilter& a, const CollisionFilter& b) {
  return (a.groups & b.mask) != 0 && (b.groups & a.mask) != 0;
}

}  // namespace souple
