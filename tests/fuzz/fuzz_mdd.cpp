#include "check_cache.h"
#include "formats.h"
#include "souple/io/mdd.h"

namespace souple::fuzz {

void parse_mdd_bytes(std::string_view bytes) {
  MddReader reader(ByteSource(std::string(bytes), "fuzz.mdd"));
  read_ends(reader);
}

}  // namespace souple::fuzz
