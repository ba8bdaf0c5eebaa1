#include "check_cache.h"
#include "formats.h"
#include "souple/io/pc2.h"

namespace souple::fuzz {

void parse_pc2_bytes(std::string_view bytes) {
  Pc2Reader reader(ByteSource(std::string(bytes), "fuzz.pc2"));
  read_ends(reader);
}

}  // namespace souple::fuzz
