#include "render/font.h"

// The font of a build without Dear ImGui, such as the browser's: no letters. The page shows texts.

namespace souple::render {

std::vector<char32_t> code_points(std::string_view) {
  return {};
}

std::filesystem::path Font::default_file() {
  return {};
}

Font::Font(const std::filesystem::path&) {}

GlyphSheet Font::sheet(int, const std::vector<char32_t>& characters) const {
  GlyphSheet sheet;
  sheet.width = sheet.height = 1;
  sheet.coverage = {0xff};
  sheet.solid_u = sheet.solid_v = 0.5f;
  for (const char32_t character : characters) sheet.glyphs[character] = {};
  return sheet;
}

}  // namespace souple::render
