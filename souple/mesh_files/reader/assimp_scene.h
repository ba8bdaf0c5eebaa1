#pragma once

#include "souple/geometry/triangle_mesh.h"

#include <filesystem>

namespace souple::mesh_detail {

/// Reads a file with assimp in this process, without post-processing that moves vertices. Only the reader of the
/// file's own extension is asked, and it opens regular files of the mesh's folder and below only. Throws Error.
TriangleMesh read_assimp_scene(const std::filesystem::path& path);

}  // namespace souple::mesh_detail
