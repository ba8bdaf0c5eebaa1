#pragma once

#include "souple/geometry/triangle_mesh.h"
#include "souple/mesh_files/mesh_animation.h"

#include <filesystem>
#include <string>

namespace souple::mesh_detail {

/// Whether Souple was built with assimp and files of this extension (".fbx") are read with it.
bool assimp_knows(const std::string& extension);

/// Reads a file with assimp in a process of its own, souple-mesh-reader, whose processor time and memory are limited.
/// So a file that makes assimp crash or loop costs only an Error. Vertices keep each mesh's order; meshes follow the
/// order of the scene's nodes and are transformed by them. Many formats have a vertex per face corner. Groups: nodes by
/// their names, materials as "material:NAME". Throws Error if the reader fails or is missing.
TriangleMesh read_with_assimp(const std::filesystem::path& path);
MeshAnimation read_animation_with_assimp(const std::filesystem::path& path,
                                         const MeshAnimationImport& options);

}  // namespace souple::mesh_detail
