#pragma once

#include "souple/geometry/triangle_mesh.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace souple::mesh_detail {

/// Polygons one behind the other in two flat arrays, as a reader meets them.
struct FaceList {
  static constexpr std::uint32_t no_uv = ~std::uint32_t(0);

  std::vector<std::uint32_t> corners;     ///< vertex indices
  std::vector<std::uint32_t> corner_uvs;  ///< like corners, no_uv where a corner has none; or empty
  std::vector<std::size_t> ends;          ///< where each face ends in corners

  /// Closes the face whose corners were appended since the last.
  void end_face() { ends.push_back(corners.size()); }

  /// Fills triangles (fans), faces (unless all are triangles) and face_uvs (where there are any) of `mesh`.
  void store(TriangleMesh& mesh) const;
};

}  // namespace souple::mesh_detail
