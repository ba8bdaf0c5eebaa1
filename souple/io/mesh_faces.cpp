#include "souple/io/mesh_faces.h"

#include <algorithm>

namespace souple::mesh_detail {

void FaceList::store(TriangleMesh& mesh) const {
  const bool all_triangles = corners.size() == 3 * ends.size();
  const bool any_uv =
      std::any_of(corner_uvs.begin(), corner_uvs.end(), [](std::uint32_t uv) { return uv != no_uv; });
  mesh.triangles.reserve(corners.size() - 2 * ends.size());
  if (!all_triangles) mesh.faces.reserve(ends.size());
  if (any_uv) mesh.face_uvs.reserve(ends.size());
  std::size_t begin = 0;
  for (std::size_t end : ends) {
    for (std::size_t i = begin + 1; i + 1 < end; ++i) {
      mesh.triangles.push_back({corners[begin], corners[i], corners[i + 1]});
    }
    const auto first = std::ptrdiff_t(begin), last = std::ptrdiff_t(end);
    if (!all_triangles) mesh.faces.emplace_back(corners.begin() + first, corners.begin() + last);
    if (any_uv) {
      mesh.face_uvs.emplace_back();
      if (corner_uvs[begin] != no_uv)
        mesh.face_uvs.back().assign(corner_uvs.begin() + first, corner_uvs.begin() + last);
    }
    begin = end;
  }
}

}  // namespace souple::mesh_detail
