#include "souple/mesh_files/reader/assimp_scene.h"

#include "souple/error.h"
#include "souple/math/mat3.h"
#include "souple/mesh_files/mesh_faces.h"
#include "souple/mesh_files/mesh_groups.h"
#include "souple/mesh_files/mesh_text.h"
#include "souple/mesh_files/reader/folder_files.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <new>
#include <optional>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <assimp/BaseImporter.h>
#include <assimp/Importer.hpp>
#include <assimp/importerdesc.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fmt/core.h>

namespace souple::mesh_detail {

namespace {

class SceneReader {
 public:
  SceneReader(const aiScene& scene, const std::string& name) : scene_(scene), name_(name) {}

  TriangleMesh read() {
    // An explicit stack: a file may nest nodes deeper than the call stack allows.
    std::vector<std::pair<const aiNode*, aiMatrix4x4>> open = {{scene_.mRootNode, aiMatrix4x4()}};
    while (!open.empty()) {
      const auto [node, parent] = open.back();
      open.pop_back();
      const aiMatrix4x4 transform = parent * node->mTransformation;
      for (unsigned i = 0; i < node->mNumMeshes; ++i)
        append(*scene_.mMeshes[node->mMeshes[i]], *node, transform);
      for (unsigned i = node->mNumChildren; i-- > 0;) open.emplace_back(node->mChildren[i], transform);
    }
    if (mesh_.positions.empty()) throw Error(name_ + ": found no vertex, expected a mesh");
    if (!mesh_.colors.empty()) mesh_.colors.resize(mesh_.positions.size(), white_);
    if (appearance_.materials.empty()) appearance_.face_materials.clear();
    mesh_.appearance = std::move(appearance_);
    faces_.store(mesh_);
    mesh_.groups = groups_.finish();
    return std::move(mesh_);
  }

 private:
  void append(const aiMesh& part, const aiNode& node, const aiMatrix4x4& transform) {
    const std::size_t first = mesh_.positions.size();
    if (first + part.mNumVertices >= FaceList::no_uv)
      throw Error(name_ + ": holds more than 2^32 - 2 vertices");
    append_vertices(part, transform);
    const std::size_t first_uv = mesh_.uvs.size();
    if (part.HasTextureCoords(0)) {
      for (unsigned i = 0; i < part.mNumVertices; ++i) {
        mesh_.uvs.push_back({part.mTextureCoords[0][i].x, part.mTextureCoords[0][i].y});
      }
    }
    const std::size_t first_normal = appearance_.normals.size();
    if (part.HasNormals()) append_normals(part, transform);
    const std::uint32_t material = material_of(part);
    for (unsigned face = 0; face < part.mNumFaces; ++face)
      append_face(part, part.mFaces[face], {first, first_uv, first_normal, material});
    append_group(node.mName.C_Str(), "", first);
    if (part.mMaterialIndex < scene_.mNumMaterials) {
      append_group(scene_.mMaterials[part.mMaterialIndex]->GetName().C_Str(), "material:", first);
    }
  }

  void append_normals(const aiMesh& part, const aiMatrix4x4& transform) {
    aiMatrix3x3 of_normals(transform);
    of_normals.Inverse().Transpose();
    for (unsigned i = 0; i < part.mNumVertices; ++i) {
      const aiVector3D n = of_normals * part.mNormals[i];
      const Vec3d normal{double(n.x), double(n.y), double(n.z)};
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

  void append_vertices(const aiMesh& part, const aiMatrix4x4& transform) {
    const std::size_t first = mesh_.positions.size();
    for (unsigned i = 0; i < part.mNumVertices; ++i) {
      const aiVector3D p = transform * part.mVertices[i];
      const Vec3d position(double(p.x), double(p.y), double(p.z));
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

/// Meters per unit of an FBX, which states the centimeters of its unit.
double unit_of(const aiMetadata& stated) {
  float centimeters = 0;
  const bool states_unit = stated.Get("UnitScaleFactor", centimeters);
  return states_unit && std::isfinite(centimeters) && centimeters > 0 ? 0.01 * double(centimeters) : 1;
}

/// An axis of the file (0, 1, 2: X, Y, Z) with its sign, as a unit vector; empty if it is not stated.
std::optional<Vec3d> stated_axis(const aiMetadata& stated, const char* axis_key, const char* sign_key) {
  std::int32_t axis = -1, sign = 1;
  if (!stated.Get(axis_key, axis) || axis < 0 || axis > 2) return {};
  stated.Get(sign_key, sign);
  Vec3d unit;
  unit[axis] = sign < 0 ? -1 : 1;
  return unit;
}

/// The rotation from the axes of an FBX to ours: up to Y, and front, which faces the viewer, to Z. A file without
/// a front that is perpendicular to its up is turned as MeshImport::up does. The third axis follows from
/// these two: a left-handed file is turned, never mirrored.
Mat3d axes_of(const aiMetadata& stated) {
  const Vec3d up = stated_axis(stated, "UpAxis", "UpAxisSign").value_or(Vec3d{0, 1, 0});
  Vec3d front = stated_axis(stated, "FrontAxis", "FrontAxisSign").value_or(up);
  if (dot(front, up) != 0) front = up.z != 0 ? Vec3d{0, -up.z, 0} : Vec3d{0, 0, 1};
  return transpose(Mat3d(cross(up, front), up, front));
}

/// Turns an FBX to our axes and meters, which assimp leaves to its caller.
void convert_fbx(const aiMetadata& stated, TriangleMesh& mesh) {
  const double unit = unit_of(stated);
  const Mat3d axes = axes_of(stated);
  for (Vec3d& x : mesh.positions) x = axes * x * unit;
  for (Vec3f& n : mesh.appearance.normals) n = Vec3f(axes * Vec3d(n));
}

/// Leaves only the readers of this extension (".fbx"): assimp would ask all others about a file of wrong content.
void keep_readers_of(const std::string& extension, Assimp::Importer& importer) {
  const auto reads = [&](std::size_t i) {
    std::istringstream words(importer.GetImporterInfo(i)->mFileExtensions);
    for (std::string word; words >> word;) {
      if ("." + lower_case(word) == extension) return true;
    }
    return false;
  };
  for (std::size_t i = importer.GetImporterCount(); i-- > 0;) {
    if (reads(i)) continue;
    Assimp::BaseImporter* const unwanted = importer.GetImporter(i);
    importer.UnregisterLoader(unwanted);
    delete unwanted;
  }
}

}  // namespace

TriangleMesh read_assimp_scene(const std::filesystem::path& path) {
  const std::string name = path.string(), extension = lower_case(path.extension().string());
  try {
    Assimp::Importer importer;
    keep_readers_of(extension, importer);
    importer.SetIOHandler(files_of_folder(path));  // which the importer deletes
    // assimp 5.4 turns to the stated axes by itself, earlier versions do not know this property.
    importer.SetPropertyBool("AI_CONFIG_IMPORT_FBX_IGNORE_UP_DIRECTION", true);
    const aiScene* scene = importer.ReadFile(name, aiProcess_ValidateDataStructure);
    if (scene == nullptr || scene->mRootNode == nullptr) {
      throw Error(name + ": assimp cannot read it (" + importer.GetErrorString() + "), expected a " +
                  extension + " file, and all that it names in its folder or below");
    }
    TriangleMesh mesh = SceneReader(*scene, name).read();
    if (extension == ".fbx" && scene->mMetaData != nullptr) convert_fbx(*scene->mMetaData, mesh);
    return mesh;
  } catch (const Error&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& failure) {
    throw Error(name + ": assimp cannot read it (" + failure.what() + ")");
  }
}

}  // namespace souple::mesh_detail
