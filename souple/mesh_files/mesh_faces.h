#pragma once

#include "souple/geometry/triangle_mesh.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace souple::mesh_detail {

/// Polygons in flat arrays, in the order of the file.
struct FaceList {
  static constexpr std::uint32_t no_uv = ~std::uint32_t(0);
  static constexpr std::uint32_t no_normal = ~std::uint32_t(0);

  std::vector<std::uint32_t> corners;     ///< vertex indices
  std::vector<std::uint32_t> corner_uvs;  ///< per corner: index of its UV, or no_uv; empty: no UVs at all
  /// Per corner: index of its normal, or no_normal; empty: no normals at all.
  std::vector<std::uint32_t> corner_normals;
  std::vector<std::size_t> ends;  ///< per face: its end in `corners`

  /// Ends a face: the corners appended since the previous call.
  void end_face() { ends.push_back(corners.size()); }

  /// Fills triangles (fans), faces (unless all are triangles), face_uvs and face_normals (if there are any) of
  /// `mesh`.
  void store(TriangleMesh& mesh) const;
};

}  // namespace souple::mesh_detail
