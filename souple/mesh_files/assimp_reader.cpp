#include "souple/mesh_files/assimp_reader.h"

#include "souple/error.h"
#include "souple/mesh_files/assimp_formats.h"
#include "souple/mesh_files/mesh_file.h"

#include <algorithm>

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

TriangleMesh read_with_assimp(const std::filesystem::path& path) {
#ifdef SOUPLE_WITH_ASSIMP
  return mesh_of_message(run_mesh_reader(path), path.string());
#else
  throw Error(path.string() +
              ": needs assimp: install the Debian package libassimp-dev and build Souple again");
#endif
}

}  // namespace mesh_detail

}  // namespace souple
