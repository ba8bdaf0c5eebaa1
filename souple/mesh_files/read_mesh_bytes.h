#pragma once

#include <filesystem>
#include <string>

namespace souple {

/// The content of a regular file. Throws Error, also where there is no such file.
std::string read_mesh_bytes(const std::filesystem::path& path);

}  // namespace souple
