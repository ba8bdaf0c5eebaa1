#include "souple/io/assimp_reader.h"

#include "souple/error.h"
#include "souple/io/mesh_faces.h"
#include "souple/io/mesh_file.h"
#include "souple/io/mesh_groups.h"
#include "souple/io/mesh_text.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <fmt/core.h>

#ifdef SOUPLE_WITH_ASSIMP
#include <assimp/Importer.hpp>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#endif

namespace souple {

#ifdef SOUPLE_WITH_ASSIMP

bool mesh_import_has_assimp() {
  return true;
}

namespace mesh_detail {

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
    for (unsigned face = 0; face < part.mNumFaces; ++face)
      append_face(part, part.mFaces[face], first, first_uv);
    append_group(node.mName.C_Str(), "", first);
    if (part.mMaterialIndex < scene_.mNumMaterials) {
      append_group(scene_.mMaterials[part.mMaterialIndex]->GetName().C_Str(), "material:", first);
    }
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

  void append_face(const aiMesh& part, const aiFace& face, std::size_t first, std::size_t first_uv) {
    if (face.mNumIndices < 3) return;  // points and lines
    for (unsigned i = 0; i < face.mNumIndices; ++i) {
      const unsigned corner = face.mIndices[i];
      if (corner >= part.mNumVertices) {
        throw Error(fmt::format("{}: found vertex index {} in a mesh of {} vertices, expected a smaller one",
                                name_, corner, part.mNumVertices));
      }
      faces_.corners.push_back(std::uint32_t(first + corner));
      faces_.corner_uvs.push_back(part.HasTextureCoords(0) ? std::uint32_t(first_uv + corner)
                                                           : FaceList::no_uv);
    }
    faces_.end_face();
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
  GroupBuilder groups_;
};

}  // namespace

bool assimp_knows(const std::string& extension) {
  return !extension.empty() && Assimp::Importer().IsExtensionSupported(extension);
}

TriangleMesh read_with_assimp(const std::filesystem::path& path) {
  const std::string name = path.string();
  try {
    Assimp::Importer importer;
    const aiScene* scene = importer.ReadFile(name, aiProcess_ValidateDataStructure);
    if (scene == nullptr || scene->mRootNode == nullptr) {
      throw Error(name + ": assimp cannot read it (" + importer.GetErrorString() + "), expected a " +
                  path.extension().string() + " file");
    }
    return SceneReader(*scene, name).read();
  } catch (const Error&) {
    throw;
  } catch (const std::exception& failure) {
    throw Error(name + ": assimp cannot read it (" + failure.what() + ")");
  }
}

}  // namespace mesh_detail

#else

bool mesh_import_has_assimp() {
  return false;
}

namespace mesh_detail {

bool assimp_knows(const std::string&) {
  return false;
}

TriangleMesh read_with_assimp(const std::filesystem::path& path) {
  throw Error(path.string() +
              ": needs assimp: install the Debian package libassimp-dev and build Souple again");
}

}  // namespace mesh_detail

#endif

}  // namespace souple
