#include "check_mesh.h"
#include "formats.h"
#include "souple/mesh_files/mesh_parse.h"

namespace souple::fuzz {

void parse_ply_bytes(std::string_view bytes) {
  check(parse_ply(bytes, "fuzz.ply"));
}

}  // namespace souple::fuzz
