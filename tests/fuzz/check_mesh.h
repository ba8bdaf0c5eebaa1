#pragma once

#include "require.h"
#include "souple/geometry/tet_mesh.h"
#include "souple/geometry/triangle_mesh.h"

#include <cstdint>

namespace souple::fuzz {

inline void check(const TriangleMesh& mesh) {
  const auto count = mesh.positions.size();
  for (const Vec3d& p : mesh.positions) require(is_finite(Vec3f(p)));
  for (const Triangle& t : mesh.triangles) {
    for (std::uint32_t i : t) require(i < count);
  }
  for (const auto& face : mesh.faces) {
    require(face.size() >= 3);
    for (std::uint32_t i : face) require(i < count);
  }
  for (const auto& face : mesh.face_uvs) {
    for (std::uint32_t i : face) require(i < mesh.uvs.size());
  }
  for (const auto& group : mesh.groups) {
    for (std::uint32_t i : group.second) require(i < count);
  }
  const FaceAppearance& a = mesh.appearance;
  const auto faces = mesh.faces.empty() ? mesh.triangles.size() : mesh.faces.size();
  require(a.face_materials.empty() || a.face_materials.size() == faces);
  for (std::uint32_t i : a.face_materials)
    require(i < a.materials.size() || i == FaceAppearance::no_material);
  require(a.smoothing.empty() || a.smoothing.size() == faces);
  require(a.face_normals.empty() || a.face_normals.size() == faces);
  for (const auto& face : a.face_normals) {
    for (std::uint32_t i : face) require(i < a.normals.size());
  }
  require(mesh.colors.empty() || mesh.colors.size() == count);
}

inline void check(const TetMesh& mesh) {
  const auto count = mesh.positions.size();
  require(!mesh.tets.empty());
  for (const Vec3d& p : mesh.positions) require(is_finite(Vec3f(p)));
  for (const Tet& tet : mesh.tets) {
    for (std::uint32_t i : tet) require(i < count);
  }
  for (const auto& group : mesh.groups) {
    for (std::uint32_t i : group.second) require(i < count);
  }
}

}  // namespace souple::fuzz
