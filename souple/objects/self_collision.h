#pragma once

#include <cstdint>

namespace souple {

/// How an object collides with itself.
enum class SelfCollision : std::uint8_t {
  off,
  /// Balls at its vertices, as games have it: fast, but parts of it may pass through each other. Only objects with
  /// triangles: cloth and soft bodies made of tets.
  particles,
  surfaces  ///< no edge passes through a triangle, no segment of a rope through another
};

}  // namespace souple
