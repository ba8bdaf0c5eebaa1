#include "souple/mesh_files/mesh_faces.h"

#include <algorithm>

namespace souple::mesh_detail {

namespace {

/// Lists per face of values per corner; empty if no corner has one. A face lacks them unless all its corners
/// have one.
std::vector<std::vector<std::uint32_t>> lists_of(const std::vector<std::uint32_t>& of_corner,
                                                 const std::vector<std::size_t>& ends, std::uint32_t none) {
  std::vector<std::vector<std::uint32_t>> lists;
  if (std::all_of(of_corner.begin(), of_corner.end(), [none](std::uint32_t i) { return i == none; }))
    return lists;
  lists.reserve(ends.size());
  auto begin = of_corner.begin();
  for (const std::size_t end : ends) {
    const auto last = of_corner.begin() + std::ptrdiff_t(end);
    lists.emplace_back();
    if (std::find(begin, last, none) == last) lists.back().assign(begin, last);
    begin = last;
  }
  return lists;
}

}  // namespace

void FaceList::store(TriangleMesh& mesh) const {
  const bool all_triangles = corners.size() == 3 * ends.size();
  mesh.triangles.reserve(corners.size() - 2 * ends.size());
  if (!all_triangles) mesh.faces.reserve(ends.size());
  std::size_t begin = 0;
  for (std::size_t end : ends) {
    for (std::size_t i = begin + 1; i + 1 < end; ++i) {
      mesh.triangles.push_back({corners[begin], corners[i], corners[i + 1]});
    }
    if (!all_triangles)
      mesh.faces.emplace_back(corners.begin() + std::ptrdiff_t(begin), corners.begin() + std::ptrdiff_t(end));
    begin = end;
  }
  mesh.face_uvs = lists_of(corner_uvs, ends, no_uv);
  mesh.appearance.face_normals = lists_of(corner_normals, ends, no_normal);
}

}  // namespace souple::mesh_detail
