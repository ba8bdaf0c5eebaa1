#include "formats.h"
#include "require.h"
#include "souple/scene/scene.h"

#include <string>

namespace souple::fuzz {

// Mesh files are looked for where the shipped scenes have theirs, and never read.
void parse_scene_bytes(std::string_view bytes) {
  const char* const folder = SOUPLE_SOURCE_DIR "/scenes";
  const std::string text = to_json(parse_scene(bytes, folder, "fuzz.json"));
  require(must_read([&] { return to_json(parse_scene(text, folder, "again.json")); }) == text);
}

}  // namespace souple::fuzz
