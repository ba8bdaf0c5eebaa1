#include "souple/mesh_files/reader/assimp_scene.h"

#include "souple/error.h"
#include "souple/math/mat3.h"
#include "souple/mesh_files/mesh_faces.h"
#include "souple/mesh_files/mesh_groups.h"
#include "souple/mesh_files/mesh_text.h"
#include "souple/mesh_files/reader/assimp_file.h"
#include "souple/mesh_files/reader/pose.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include <assimp/scene.h>
#include <fmt/core.h>

namespace souple::mesh_detail {

namespace {

class SceneReader {
 public:
  SceneReader(const aiScene& scene, const std::string& name) : scene_(scene), name_(name) {}

  TriangleMesh read() {
    const Pose pose(scene_, name_);
    for (const ScenePart& part : parts_of(scene_)) append(part, pose.placements(part), pose.vertices(part));
    if (mesh_.positions.empty()) throw Error(name_ + ": found no vertex, expected a mesh");
    if (!mesh_.colors.empty()) mesh_.colors.resize(mesh_.positions.size(), white_);
    if (appearance_.materials.empty()) appearance_.face_materials.clear();
    mesh_.appearance = std::move(appearance_);
    faces_.store(mesh_);
    mesh_.groups = groups_.finish();
    return std::move(mesh_);
  }

 private:
  void append(const ScenePart& of_node, const std::vector<Affine>& placements,
              const std::vector<Vec3d>& vertices) {
    const aiMesh& part = *of_node.mesh;
    const std::size_t first = mesh_.positions.size();
    if (first + part.mNumVertices >= FaceList::no_uv)
      throw Error(name_ + ": holds more than 2^32 - 2 vertices");
    append_vertices(part, placements, vertices);
    const std::size_t first_uv = mesh_.uvs.size();
    if (part.HasTextureCoords(0)) {
      for (unsigned i = 0; i < part.mNumVertices; ++i) {
        mesh_.uvs.push_back({part.mTextureCoords[0][i].x, part.mTextureCoords[0][i].y});
      }
    }
    const std::size_t first_normal = appearance_.normals.size();
    if (part.HasNormals()) append_normals(part, placements);
    const std::uint32_t material = material_of(part);
    for (unsigned face = 0; face < part.mNumFaces; ++face)
      append_face(part, part.mFaces[face], {first, first_uv, first_normal, material});
    append_group(of_node.node->mName.C_Str(), "", first);
    if (part.mMaterialIndex < scene_.mNumMaterials) {
      append_group(scene_.mMaterials[part.mMaterialIndex]->GetName().C_Str(), "material:", first);
    }
  }

  void append_normals(const aiMesh& part, const std::vector<Affine>& placements) {
    for (unsigned i = 0; i < part.mNumVertices; ++i) {
      const aiVector3D& n = part.mNormals[i];
      // The cofactors are det times the inverse's transpose: of a mirrored part the normals are turned back.
      const Mat3d& linear = placements[i].linear;
      const double side = determinant(linear) < 0 ? -1 : 1;
      const Vec3d normal = cofactor(linear) * Vec3d{double(n.x), double(n.y), double(n.z)} * side;
      const double l = length(normal);
      appearance_.normals.push_back(std::isfinite(l) && l > 0 ? Vec3f(normal / l) : Vec3f{0, 1, 0});
    }
  }

  std::uint32_t material_of(const aiMesh& part) {
    if (part.mMaterialIndex >= scene_.mNumMaterials) return FaceAppearance::no_material;
    std::string name = scene_.mMaterials[part.mMaterialIndex]->GetName().C_Str();
    std::replace_if(
        name.begin(), name.end(), [](char c) { return c >= 0 && c < ' '; }, '_');
    if (name.empty() || name == AI_DEFAULT_MATERIAL_NAME) return FaceAppearance::no_material;
    std::vector<std::string>& names = appearance_.materials;
    const auto known = std::find(names.begin(), names.end(), name);
    if (known != names.end()) return std::uint32_t(known - names.begin());
    names.push_back(name);
    return std::uint32_t(names.size() - 1);
  }

  void append_vertices(const aiMesh& part, const std::vector<Affine>& placements,
                       const std::vector<Vec3d>& vertices) {
    const std::size_t first = mesh_.positions.size();
    for (unsigned i = 0; i < part.mNumVertices; ++i) {
      const Vec3d position = placements[i].point(vertices[i]);
      const double size = std::max({std::abs(position.x), std::abs(position.y), std::abs(position.z)});
      if (!is_finite(position) || size > largest_coordinate) {
        throw Error(fmt::format(
            "{}: vertex {}: found a coordinate that is not finite or too large, expected numbers within 1e18",
            name_, first + i));
      }
      mesh_.positions.push_back(position);
    }
    if (!part.HasVertexColors(0)) return;
    mesh_.colors.resize(first, white_);
    for (unsigned i = 0; i < part.mNumVertices; ++i) {
      const aiColor4D& c = part.mColors[0][i];
      mesh_.colors.emplace_back(in_range(c.r), in_range(c.g), in_range(c.b));
    }
  }

  static float in_range(float channel) { return channel >= 0.0f ? std::min(channel, 1.0f) : 0.0f; }

  /// Numbers of a mesh's first vertex, UV and normal, and its material.
  struct Place {
    std::size_t vertex, uv, normal;
    std::uint32_t material;
  };
  void append_face(const aiMesh& part, const aiFace& face, const Place& first) {
    if (face.mNumIndices < 3) return;  // points and lines
    for (unsigned i = 0; i < face.mNumIndices; ++i) {
      const unsigned corner = face.mIndices[i];
      if (corner >= part.mNumVertices) {
        throw Error(fmt::format("{}: found vertex index {} in a mesh of {} vertices, expected a smaller one",
                                name_, corner, part.mNumVertices));
      }
      faces_.corners.push_back(std::uint32_t(first.vertex + corner));
      faces_.corner_uvs.push_back(part.HasTextureCoords(0) ? std::uint32_t(first.uv + corner)
                                                           : FaceList::no_uv);
      faces_.corner_normals.push_back(part.HasNormals() ? std::uint32_t(first.normal + corner)
                                                        : FaceList::no_normal);
    }
    faces_.end_face();
    appearance_.face_materials.push_back(first.material);
  }

  void append_group(const std::string& group_name, const char* prefix, std::size_t first) {
    if (group_name.empty()) return;
    std::vector<std::uint32_t>& group = groups_[prefix + group_name];
    for (std::size_t i = first; i < mesh_.positions.size(); ++i) group.push_back(std::uint32_t(i));
  }

  const aiScene& scene_;
  std::string name_;
  Vec3f white_{1.0f, 1.0f, 1.0f};
  TriangleMesh mesh_;
  FaceList faces_;
  FaceAppearance appearance_;
  GroupBuilder groups_;
};

}  // namespace

TriangleMesh read_assimp_scene(const std::filesystem::path& path) {
  TriangleMesh mesh;
  with_assimp_scene(path, [&](const aiScene& scene, const Mat3d& axes, double unit) {
    mesh = SceneReader(scene, path.string()).read();
    for (Vec3d& x : mesh.positions) x = axes * x * unit;
    for (Vec3f& n : mesh.appearance.normals) n = Vec3f(axes * Vec3d(n));
  });
  return mesh;
}

}  // namespace souple::mesh_detail
