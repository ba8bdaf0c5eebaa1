#include "check_mesh.h"
#include "formats.h"
#include "souple/mesh_files/mesh_parse.h"

namespace souple::fuzz {

void parse_stl_bytes(std::string_view bytes) {
  check(parse_stl(bytes, "fuzz.stl"));
}

}  // namespace souple::fuzz
