#pragma once

#include "souple/geometry/measures.h"
#include "souple/surface/fluid_surface.h"

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <utility>
#include <vector>

namespace souple::test {

/// Topology of a mesh. For a closed surface of one piece, vertices - edges + triangles = 2 - 2 handles.
struct Topology {
  std::size_t wrong_edges = 0;    ///< edges that are not in two triangles, once in each direction
  std::size_t wrong_corners = 0;  ///< vertices whose triangles are not one fan around them
  long euler = 0;
  bool is_closed_manifold() const { return wrong_edges == 0 && wrong_corners == 0; }
};

inline Topology topology_of(std::size_t vertices, std::span<const Triangle> triangles) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> sides;
  std::vector<std::map<std::uint32_t, std::uint32_t>> next(vertices);  // around each vertex
  for (const Triangle& t : triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      ++sides[{t[k], t[(k + 1) % 3]}];
      next[t[k]][t[(k + 1) % 3]] = t[(k + 2) % 3];
    }
  }
  Topology result;
  for (const auto& [side, count] : sides)
    if (count != 1 || !sides.contains({side.second, side.first})) ++result.wrong_edges;
  if (result.wrong_edges > 0) return result;
  for (const auto& around : next) {
    std::size_t steps = 0;
    if (!around.empty()) {
      const std::uint32_t start = around.begin()->first;
      std::uint32_t at = start;
      do at = around.at(at), ++steps;
      while (at != start && steps <= around.size());
    }
    if (steps != around.size() || steps == 0) ++result.wrong_corners;
  }
  result.euler =
      static_cast<long>(vertices) - static_cast<long>(sides.size() / 2) + static_cast<long>(triangles.size());
  return result;
}

inline Topology topology_of(const SurfaceMesh& mesh) {
  return topology_of(mesh.positions.size(), mesh.triangles);
}

inline double volume_of(const SurfaceMesh& mesh) {
  std::vector<Vec3d> positions;
  for (const Vec3f& x : mesh.positions) positions.emplace_back(x);
  return enclosed_volume(positions, mesh.triangles);
}

}  // namespace souple::test
