#pragma once

#include <filesystem>

namespace Assimp {  // NOLINT(readability-identifier-naming): of assimp
class IOSystem;
}

namespace souple::mesh_detail {

/// The files that assimp may open for a mesh: the mesh itself, and regular files below its folder. No other path, no
/// link that leaves the folder, no pipe, no device, and nothing to write. For Importer::SetIOHandler, which deletes it.
Assimp::IOSystem* files_of_folder(const std::filesystem::path& mesh);

}  // namespace souple::mesh_detail
