#pragma once

#include "souple/geometry/triangle_mesh.h"

#include <filesystem>
#include <string>

namespace souple::mesh_detail {

/// Whether assimp is there and reads files of this extension (".fbx").
bool assimp_knows(const std::string& extension);

/// Reads through assimp, with no post-processing that would move a vertex: the vertices of each mesh in its
/// order, mesh by mesh in the order of the scene's nodes, moved by the node's transform. Many formats have a
/// vertex per face corner. Groups: nodes by their names, materials as "material:NAME". Throws Error where
/// assimp fails or is not there.
TriangleMesh read_with_assimp(const std::filesystem::path& path);

}  // namespace souple::mesh_detail
