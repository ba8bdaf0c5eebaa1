#pragma once

#include "souple/geometry/triangle_mesh.h"

#include <cstdint>
#include <span>
#include <vector>

namespace souple {

/// A mesh with one UV per vertex, as glTF requires: a vertex at a seam of the UVs is there several times. The first
/// vertices are those of the source, in order; copies follow.
struct SplitMesh {
  struct Part {
    std::uint32_t material = FaceAppearance::no_material;  ///< index into FaceAppearance::materials
    std::vector<Triangle> triangles;                       ///< in the order of the source
  };

  std::size_t source_vertices = 0;
  std::vector<std::uint32_t> copies;      ///< per copy: vertex of the source
  std::vector<std::array<float, 2>> uvs;  ///< empty, or one per vertex and copy
  std::vector<Part> parts;                ///< in order of their first triangle

  std::size_t size() const { return source_vertices + copies.size(); }
  /// The source's vertex of a vertex or copy.
  std::uint32_t source(std::size_t vertex) const;
  /// Values per vertex of the source, and once more for each copy.
  std::vector<Vec3f> spread(std::span<const Vec3f> values) const;
};

/// A vertex that no face with a UV uses has the UV 0, 0.
SplitMesh split_mesh(const TriangleMesh& mesh);

/// The faces whose corners all belong to a group, ascending: how formats with groups of faces hold groups of vertices.
std::vector<std::uint32_t> faces_of_group(const TriangleMesh& mesh, std::span<const std::uint32_t> vertices);

/// Whether vertex normals show the surface as it is meant: no edge of two triangles is sharper than 50 degrees. A box
/// is not smooth; without normals, programs show its faces flat.
bool is_smooth(std::span<const Vec3d> positions, std::span<const Triangle> triangles);

}  // namespace souple
