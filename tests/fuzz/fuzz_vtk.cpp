#include "check_mesh.h"
#include "formats.h"
#include "souple/mesh_files/mesh_parse.h"

namespace souple::fuzz {

void parse_vtk_bytes(std::string_view bytes) {
  check(parse_vtk(bytes, "fuzz.vtk"));
}

}  // namespace souple::fuzz
