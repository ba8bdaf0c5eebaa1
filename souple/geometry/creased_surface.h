#pragma once

#include "souple/geometry/triangle_mesh.h"
#include "souple/math/vec3.h"

#include <cstdint>
#include <span>
#include <vector>

namespace souple {

/// A surface for rendering with sharp edges: vertices on sharp edges are duplicated, one per adjacent smooth
/// part, each with its own normal.
class CreasedSurface {
 public:
  CreasedSurface() = default;
  /// Edges are sharp where triangles meet at more than 60 degrees at rest.
  CreasedSurface(std::span<const Vec3d> rest, std::span<const Triangle> triangles);

  /// Whether there is a sharp edge; without one the surface is unchanged.
  bool has_creases() const { return source_.size() > vertices_; }
  /// Updates positions and normals from the `positions` of the given vertices.
  void update(std::span<const Vec3f> positions);

  std::span<const Vec3f> positions() const { return positions_; }
  std::span<const Vec3f> normals() const { return normals_; }
  std::span<const Triangle> triangles() const { return triangles_; }
  /// Per vertex of this surface: the index of the given vertex.
  std::span<const std::uint32_t> source() const { return source_; }

 private:
  std::size_t vertices_ = 0;  ///< number of given vertices
  std::vector<Triangle> triangles_;
  std::vector<std::uint32_t> source_;
  std::vector<Vec3f> positions_, normals_;
};

}  // namespace souple
