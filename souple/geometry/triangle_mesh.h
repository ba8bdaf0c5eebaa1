#pragma once

#include "souple/math/vec3.h"

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace souple {

using Triangle = std::array<std::uint32_t, 3>;

/// The appearance of a surface's faces as its file states it: the simulation ignores it, caches repeat it.
struct FaceAppearance {
  static constexpr std::uint32_t no_material = ~std::uint32_t(0);

  std::vector<std::string> material_files;  ///< files that define the materials (mtllib of OBJ)
  std::vector<std::string> materials;       ///< names of the materials
  /// Per face: index into materials, or no_material; empty if no face has a material.
  std::vector<std::uint32_t> face_materials;
  std::vector<std::uint32_t> smoothing;  ///< per face: smoothing group, 0 is flat; empty if not stated
  std::vector<Vec3f> normals;            ///< unit, indexed by face_normals
  /// Per face corner: index into normals; empty, or shaped like faces (an empty list: a face without).
  std::vector<std::vector<std::uint32_t>> face_normals;

  friend bool operator==(const FaceAppearance& a, const FaceAppearance& b) {
    return a.material_files == b.material_files && a.materials == b.materials &&
           a.face_materials == b.face_materials && a.smoothing == b.smoothing && a.normals == b.normals &&
           a.face_normals == b.face_normals;
  }
};

/// A surface as given by its file or builder: vertices, order, faces, UVs and groups are kept for caches.
/// Triangles are fans of the faces, in order; a face may have any number of corners >= 3.
struct TriangleMesh {
  std::vector<Vec3d> positions;     ///< meters, in user order
  std::vector<Triangle> triangles;  ///< vertex indices, counterclockwise seen from outside
  std::vector<std::array<float, 2>>
      uvs;  ///< empty, or indexed by face_uvs; one per vertex if face_uvs is empty
  std::vector<std::vector<std::uint32_t>> faces;  ///< polygons as read; empty if all are triangles
  std::vector<std::vector<std::uint32_t>>
      face_uvs;               ///< per face corner: index into uvs; empty, or shaped like faces
  std::vector<Vec3f> colors;  ///< empty, or one per vertex, linear RGB in [0, 1]
  /// Vertex indices of each named group, ascending.
  std::map<std::string, std::vector<std::uint32_t>> groups;
  FaceAppearance appearance{};
};

}  // namespace souple
