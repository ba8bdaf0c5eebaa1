#pragma once

#include "souple/math/mat3.h"

#include <filesystem>
#include <functional>

struct aiScene;

namespace souple::mesh_detail {

/// A scene, and how its coordinates x become meters with Y up: axes x unit.
using SceneVisitor = std::function<void(const aiScene& scene, const Mat3d& axes, double unit)>;

/// Reads a file with assimp in this process, without post-processing that moves vertices, and calls `visit`. Only the
/// reader of the file's own extension is asked, and it opens regular files of the mesh's folder and below only. FBX states
/// its axes and unit; other files are taken as they are. Throws Error.
void with_assimp_scene(const std::filesystem::path& path, const SceneVisitor& visit);

}  // namespace souple::mesh_detail
