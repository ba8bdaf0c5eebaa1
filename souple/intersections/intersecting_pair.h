#pragma once

#include <cstddef>
#include <cstdint>

namespace souple {

/// Two intersecting objects, or one with self-intersections.
struct IntersectingPair {
  std::uint32_t edge_surface = 0, surface = 0;  ///< indices of the objects of the edges and of the triangles
  std::size_t edges = 0;                        ///< number of edges that pass through triangles
  bool immovable = false;                       ///< no particle of these edges and triangles can move
};

}  // namespace souple
