#pragma once

#include "souple/mesh_files/mesh_animation.h"

#include <filesystem>

namespace souple::mesh_detail {

/// Evaluates an animation of a file with assimp in this process. Throws Error.
MeshAnimation read_assimp_animation(const std::filesystem::path& path, const MeshAnimationImport& options);

}  // namespace souple::mesh_detail
