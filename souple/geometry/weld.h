#pragma once

#include "souple/geometry/triangle_mesh.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace souple {

/// A map between user vertices and simulated particles: files duplicate vertices at UV seams and creases, and
/// the duplicates must move as one. The user's mesh is never changed.
struct Weld {
  std::vector<std::uint32_t> to_welded;  ///< per user vertex: its welded vertex
  /// Per welded vertex: its representative, the lowest of its user vertices.
  std::vector<std::uint32_t> to_vertex;
  std::size_t size() const { return to_vertex.size(); }
};

/// Joins coincident vertices. In index order, each vertex joins the lowest earlier representative within
/// `tolerance` meters (0: equal coordinates), or becomes a representative. So welded vertices keep the user's
/// order, chains do not collapse, and no vertex moves further than the tolerance. Non-finite vertices stay
/// alone. Throws Error if the tolerance is negative or not finite.
Weld weld_vertices(std::span<const Vec3d> positions, double tolerance = 0);

/// 1e-9 of the bounding box's diagonal: joins vertices that differ by a file's rounding, but no detail.
double rounding_tolerance(std::span<const Vec3d> positions);

/// One value per welded vertex: that of its representative.
template <class T>
std::vector<T> gather(const Weld& weld, std::span<const T> per_vertex) {
  std::vector<T> result;
  result.reserve(weld.size());
  for (const std::uint32_t vertex : weld.to_vertex) result.push_back(per_vertex[vertex]);
  return result;
}

/// Triangles over welded vertices, without triangles that lost an edge (two corners became one).
struct WeldedTriangles {
  std::vector<Triangle> triangles;
  std::vector<std::uint32_t> source;  ///< per triangle: its index in the user's mesh
};
WeldedTriangles weld_triangles(const Weld& weld, std::span<const Triangle> triangles);

}  // namespace souple
