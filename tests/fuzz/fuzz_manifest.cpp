#include "formats.h"
#include "require.h"
#include "souple/io/manifest.h"

#include <string>

namespace souple::fuzz {

void parse_manifest_bytes(std::string_view bytes) {
  const std::string text = manifest_text(parse_manifest(bytes, "fuzz.json"));
  require(must_read([&] { return manifest_text(parse_manifest(text, "again.json")); }) == text);
}

}  // namespace souple::fuzz
