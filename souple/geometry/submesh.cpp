#include "souple/geometry/submesh.h"

#include <algorithm>
#include <vector>

namespace souple {

namespace {

using Indices = std::vector<std::uint32_t>;

constexpr std::uint32_t dropped = ~std::uint32_t(0);

template <class Item>
std::vector<Item> gathered(const std::vector<Item>& items, std::span<const std::uint32_t> indices) {
  std::vector<Item> result;
  if (items.empty()) return result;
  result.reserve(indices.size());
  for (const std::uint32_t i : indices) result.push_back(items[i]);
  return result;
}

/// The items that `lists` refer to, in their order; the lists are renumbered.
template <class Item>
std::vector<Item> used(const std::vector<Item>& items, std::vector<Indices>& lists) {
  Indices to_new(items.size(), dropped);
  for (const Indices& list : lists)
    for (const std::uint32_t i : list) to_new[i] = 0;
  std::vector<Item> result;
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (to_new[i] == dropped) continue;
    to_new[i] = static_cast<std::uint32_t>(result.size());
    result.push_back(items[i]);
  }
  for (Indices& list : lists)
    for (std::uint32_t& i : list) i = to_new[i];
  return result;
}

/// The polygons (or triangles) whose corners all remain, renumbered; `kept` gets their indices.
template <class Face>
std::vector<Face> remaining(const std::vector<Face>& faces, const Indices& to_new, Indices& kept) {
  std::vector<Face> result;
  for (std::uint32_t f = 0; f < faces.size(); ++f) {
    Face face = faces[f];
    for (std::uint32_t& corner : face) corner = to_new[corner];
    if (std::find(face.begin(), face.end(), dropped) != face.end()) continue;
    result.push_back(std::move(face));
    kept.push_back(f);
  }
  return result;
}

FaceAppearance appearance_of(const FaceAppearance& whole, const Indices& faces) {
  FaceAppearance part;
  part.material_files = whole.material_files;
  part.materials = whole.materials;
  part.face_materials = gathered(whole.face_materials, faces);
  part.smoothing = gathered(whole.smoothing, faces);
  part.face_normals = gathered(whole.face_normals, faces);
  part.normals = used(whole.normals, part.face_normals);
  return part;
}

}  // namespace

TriangleMesh submesh(const TriangleMesh& mesh, std::span<const std::uint32_t> vertices) {
  Indices to_new(mesh.positions.size(), dropped);
  for (std::uint32_t i = 0; i < vertices.size(); ++i) to_new[vertices[i]] = i;
  TriangleMesh part;
  part.positions = gathered(mesh.positions, vertices);
  part.colors = gathered(mesh.colors, vertices);
  Indices triangles, faces;
  part.triangles = remaining(mesh.triangles, to_new, triangles);
  part.faces = remaining(mesh.faces, to_new, faces);
  const Indices& kept = mesh.faces.empty() ? triangles : faces;
  part.face_uvs = gathered(mesh.face_uvs, kept);
  if (!mesh.face_uvs.empty())
    part.uvs = used(mesh.uvs, part.face_uvs);
  else if (mesh.uvs.size() == mesh.positions.size())
    part.uvs = gathered(mesh.uvs, vertices);
  part.appearance = appearance_of(mesh.appearance, kept);
  for (const auto& [name, members] : mesh.groups) {
    Indices group;
    for (const std::uint32_t v : members)
      if (to_new[v] != dropped) group.push_back(to_new[v]);
    if (!group.empty()) part.groups[name] = std::move(group);
  }
  return part;
}

}  // namespace souple
