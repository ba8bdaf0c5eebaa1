#include "check_mesh.h"
#include "formats.h"
#include "souple/mesh_files/mesh_parse.h"

namespace souple::fuzz {

void parse_msh_bytes(std::string_view bytes) {
  check(parse_msh(bytes, "fuzz.msh"));
}

}  // namespace souple::fuzz
