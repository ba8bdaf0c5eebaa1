#include "check_mesh.h"
#include "formats.h"
#include "souple/mesh_files/mesh_parse.h"

namespace souple::fuzz {

// Both files in one: the .node, a line "--- ele ---", the .ele.
void parse_tetgen_bytes(std::string_view bytes) {
  constexpr std::string_view separator = "--- ele ---\n";
  const std::size_t at = bytes.find(separator);
  const bool both = at != std::string_view::npos;
  check(parse_tetgen(bytes.substr(0, at), "fuzz.node",
                     both ? bytes.substr(at + separator.size()) : std::string_view(), "fuzz.ele"));
}

}  // namespace souple::fuzz
