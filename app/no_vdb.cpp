#include "app/vdb.h"
#include "souple/error.h"

// Replaces vdb.cpp where OpenVDB was missing.

namespace souple::app {

bool has_vdb() {
  return false;
}

void require_vdb() {
  throw Error(
      "--format vdb: this program was built without OpenVDB: install the Debian packages libopenvdb-dev "
      "libboost-dev and build it again (CMake option SOUPLE_WITH_VDB), or choose obj or ply");
}

std::string vdb_bytes(const NarrowBand&, const std::string&, std::span<const Vec3f>) {
  require_vdb();
  return {};
}

}  // namespace souple::app
