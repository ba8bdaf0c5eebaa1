#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace souple::mesh_detail {

/// Runs souple-mesh-reader for a mesh file, with further arguments, and returns its message (mesh_message.h). The program is looked for
/// - where the environment variable SOUPLE_MESH_READER says, alone if it is set;
/// - beside the program or shared library that holds this function, and in libexec/souple one or two folders above it;
/// - where it is installed (or built, in a project that builds Souple as its part).
/// Throws Error if it is missing, crashes, exceeds its memory or time (assimp_formats.h), or breaks off.
std::string run_mesh_reader(const std::filesystem::path& mesh,
                            const std::vector<std::string>& arguments = {});

}  // namespace souple::mesh_detail
