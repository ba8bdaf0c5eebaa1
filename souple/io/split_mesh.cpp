#include "souple/io/split_mesh.h"

#include "souple/geometry/measures.h"

#include <algorithm>
#include <map>
#include <utility>

namespace souple {

namespace {

/// Gives each corner a vertex, and a copy of it where its UV differs from that of earlier corners.
class Splitter {
 public:
  explicit Splitter(const TriangleMesh& mesh) : mesh_(mesh), has_uv_(mesh.positions.size(), 0) {
    result_.source_vertices = mesh.positions.size();
    if (!mesh.uvs.empty()) result_.uvs.resize(mesh.positions.size());
    if (mesh.face_uvs.empty())
      std::copy_n(mesh.uvs.begin(), std::min(mesh.uvs.size(), result_.uvs.size()), result_.uvs.begin());
  }

  void add_face(std::size_t face, std::span<const std::uint32_t> corners) {
    vertices_.clear();
    for (std::size_t corner = 0; corner < corners.size(); ++corner)
      vertices_.push_back(vertex_of(face, corner, corners[corner]));
    std::vector<Triangle>& triangles = part_of(face).triangles;
    for (std::size_t corner = 2; corner < vertices_.size(); ++corner)
      triangles.push_back({vertices_[0], vertices_[corner - 1], vertices_[corner]});
  }

  SplitMesh take() && { return std::move(result_); }

 private:
  std::uint32_t vertex_of(std::size_t face, std::size_t corner, std::uint32_t vertex) {
    if (mesh_.face_uvs.empty() || mesh_.face_uvs[face].empty()) return vertex;
    const std::array<float, 2> uv = mesh_.uvs[mesh_.face_uvs[face][corner]];
    if (!std::exchange(has_uv_[vertex], char(1))) result_.uvs[vertex] = uv;
    if (result_.uvs[vertex] == uv) return vertex;
    const auto next = static_cast<std::uint32_t>(result_.size());
    const auto [copy, is_new] = copies_.try_emplace({vertex, uv}, next);
    if (is_new) {
      result_.copies.push_back(vertex);
      result_.uvs.push_back(uv);
    }
    return copy->second;
  }

  SplitMesh::Part& part_of(std::size_t face) {
    const std::vector<std::uint32_t>& materials = mesh_.appearance.face_materials;
    const std::uint32_t material = materials.empty() ? FaceAppearance::no_material : materials[face];
    const auto [part, is_new] = parts_.try_emplace(material, result_.parts.size());
    if (is_new) result_.parts.push_back({material, {}});
    return result_.parts[part->second];
  }

  const TriangleMesh& mesh_;
  std::vector<char> has_uv_;
  std::vector<std::uint32_t> vertices_;  // of the current face
  std::map<std::pair<std::uint32_t, std::array<float, 2>>, std::uint32_t> copies_;
  std::map<std::uint32_t, std::size_t> parts_;  // by material
  SplitMesh result_;
};

template <class Visit>
void for_each_face(const TriangleMesh& mesh, const Visit& visit) {
  if (mesh.faces.empty()) {
    for (std::size_t face = 0; face < mesh.triangles.size(); ++face)
      visit(face, std::span<const std::uint32_t>(mesh.triangles[face]));
  } else {
    for (std::size_t face = 0; face < mesh.faces.size(); ++face)
      visit(face, std::span<const std::uint32_t>(mesh.faces[face]));
  }
}

}  // namespace

std::uint32_t SplitMesh::source(std::size_t vertex) const {
  return vertex < source_vertices ? static_cast<std::uint32_t>(vertex) : copies[vertex - source_vertices];
}

std::vector<Vec3f> SplitMesh::spread(std::span<const Vec3f> values) const {
  std::vector<Vec3f> result(values.begin(), values.end());
  result.reserve(size());
  for (const std::uint32_t vertex : copies) result.push_back(values[vertex]);
  return result;
}

SplitMesh split_mesh(const TriangleMesh& mesh) {
  Splitter splitter(mesh);
  for_each_face(mesh, [&](std::size_t face, auto corners) { splitter.add_face(face, corners); });
  return std::move(splitter).take();
}

std::vector<std::uint32_t> faces_of_group(const TriangleMesh& mesh, std::span<const std::uint32_t> vertices) {
  std::vector<std::uint32_t> result;
  for_each_face(mesh, [&](std::size_t face, auto corners) {
    const bool inside = std::all_of(corners.begin(), corners.end(), [&](std::uint32_t vertex) {
      return std::binary_search(vertices.begin(), vertices.end(), vertex);
    });
    if (inside) result.push_back(static_cast<std::uint32_t>(face));
  });
  return result;
}

bool is_smooth(std::span<const Vec3d> positions, std::span<const Triangle> triangles) {
  constexpr double smallest_cosine = 0.6427876;  // of 50 degrees
  std::map<std::pair<std::uint32_t, std::uint32_t>, Vec3d> normal_of_edge;
  for (const Triangle& t : triangles) {
    const Vec3d normal =
        unit_normal(cross(positions[t[1]] - positions[t[0]], positions[t[2]] - positions[t[0]]));
    if (normal == Vec3d{}) continue;
    for (std::size_t i = 0; i < 3; ++i) {
      const auto edge = std::minmax(t[i], t[(i + 1) % 3]);
      const auto [other, is_new] = normal_of_edge.try_emplace({edge.first, edge.second}, normal);
      if (!is_new && dot(other->second, normal) < smallest_cosine) return false;
    }
  }
  return true;
}

}  // namespace souple
