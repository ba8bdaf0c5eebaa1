#include "souple/mesh_files/assimp_reader.h"

#include "souple/error.h"
#include "souple/mesh_files/assimp_formats.h"
#include "souple/mesh_files/mesh_file.h"

#include <algorithm>
#include <string>
#include <vector>

#include <fmt/core.h>

#ifdef SOUPLE_WITH_ASSIMP
#include "souple/mesh_files/mesh_message.h"
#include "souple/mesh_files/reader_process.h"
#endif

namespace souple {

bool mesh_import_has_assimp() {
#ifdef SOUPLE_WITH_ASSIMP
  return true;
#else
  return false;
#endif
}

namespace mesh_detail {

bool assimp_knows(const std::string& extension) {
  return mesh_import_has_assimp() &&
         std::find(assimp_formats.begin(), assimp_formats.end(), extension) != assimp_formats.end();
}

#ifdef SOUPLE_WITH_ASSIMP
TriangleMesh read_with_assimp(const std::filesystem::path& path) {
  return mesh_of_message(run_mesh_reader(path), path.string());
}
MeshAnimation read_animation_with_assimp(const std::filesystem::path& path,
                                         const MeshAnimationImport& options) {
  const std::vector<std::string> arguments = {"--animation", options.animation, options.node,
                                              fmt::format("{}", options.frame_rate)};
  return animation_of_message(run_mesh_reader(path, arguments), path.string());
}
#else
namespace {
[[noreturn]] void fail_without_assimp(const std::filesystem::path& path) {
  throw Error(path.string() +
              ": needs assimp: install the Debian package libassimp-dev and build Souple again");
}
}  // namespace
TriangleMesh read_with_assimp(const std::filesystem::path& path) {
  fail_without_assimp(path);
}
MeshAnimation read_animation_with_assimp(const std::filesystem::path& path, const MeshAnimationImport&) {
  fail_without_assimp(path);
}
#endif

}  // namespace mesh_detail

}  // namespace souple
