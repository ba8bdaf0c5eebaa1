#include "render/font.h"

#include <algorithm>
#include <fstream>
#include <imgui.h>
#include <iterator>
#include <system_error>

// Dear ImGui serves only as a font rasterizer: an ImFontAtlas needs no context.

namespace souple::render {

namespace {

/// A lead byte of UTF-8: the number of bytes that follow it, and the bits it contributes; none for an invalid
/// byte.
struct Lead {
  int more = -1;
  char32_t bits = 0;
  char32_t min_point = 0;  ///< smallest valid code point; longer encodings of smaller ones are invalid
};

Lead lead_of(unsigned char byte) {
  if (byte < 0x80) return {0, byte, 0};
  if ((byte & 0xe0) == 0xc0) return {1, byte & 0x1fu, 0x80};
  if ((byte & 0xf0) == 0xe0) return {2, byte & 0x0fu, 0x800};
  if ((byte & 0xf8) == 0xf0) return {3, byte & 0x07u, 0x10000};
  return {};
}

std::size_t big_endian(const std::vector<char>& data, std::size_t at, std::size_t bytes) {
  std::size_t value = 0;
  for (std::size_t i = 0; i < bytes; ++i) value = value << 8 | static_cast<unsigned char>(data[at + i]);
  return value;
}

/// Whether this is a TrueType font with all its tables: the rasterizer does not check its input.
bool is_whole_font(const std::vector<char>& data) {
  constexpr std::size_t head = 12, entry = 16;  // bytes; an entry is tag, checksum, offset, length
  if (data.size() < head || big_endian(data, 0, 4) != 0x00010000) return false;
  const std::size_t tables = big_endian(data, 4, 2);
  if (tables == 0 || data.size() < head + tables * entry) return false;
  for (std::size_t i = 0; i < tables; ++i) {
    const std::size_t at = head + i * entry;
    if (big_endian(data, at + 8, 4) + big_endian(data, at + 12, 4) > data.size()) return false;
  }
  return true;
}

/// Uses the font in `data`, or the built-in one if it is empty. False for a damaged font.
bool rasterize(ImFontAtlas& atlas, const std::vector<char>& data, int size, const ImVector<ImWchar>& ranges) {
  atlas.Flags = ImFontAtlasFlags_NoMouseCursors | ImFontAtlasFlags_NoBakedLines;
  ImFontConfig config;
  config.SizePixels = float(size);
  config.GlyphRanges = ranges.Data;
  config.OversampleH = 1;  // text starts at whole pixels, so no subpixel samples are needed
  config.OversampleV = 1;
  config.PixelSnapH = true;
  if (data.empty()) {
    atlas.AddFontDefault(&config);
  } else {
    config.FontDataOwnedByAtlas = false;
    auto* bytes = const_cast<char*>(data.data());  // ImGui only reads it
    atlas.AddFontFromMemoryTTF(bytes, int(data.size()), float(size), &config);
  }
  return atlas.Build();
}

GlyphSheet::Glyph glyph_of(const ImFontGlyph& glyph) {
  return {glyph.X0, glyph.Y0, glyph.X1, glyph.Y1, glyph.U0, glyph.V0, glyph.U1, glyph.V1, glyph.AdvanceX};
}

}  // namespace

std::vector<char32_t> code_points(std::string_view utf8) {
  std::vector<char32_t> result;
  for (std::size_t i = 0; i < utf8.size();) {
    const Lead lead = lead_of(static_cast<unsigned char>(utf8[i++]));
    char32_t point = lead.bits;
    int more = lead.more;
    for (; more > 0 && i < utf8.size() && (static_cast<unsigned char>(utf8[i]) & 0xc0) == 0x80; --more) {
      point = point << 6 | (static_cast<unsigned char>(utf8[i++]) & 0x3fu);
    }
    const bool good =
        more == 0 && point >= lead.min_point && point <= 0xffff && (point < 0xd800 || point > 0xdfff);
    result.push_back(good ? point : U'?');
  }
  return result;
}

std::filesystem::path Font::default_file() {
  return "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf";
}

Font::Font(const std::filesystem::path& file) {
  std::error_code error;
  std::ifstream in(file, std::ios::binary);
  if (in && std::filesystem::is_regular_file(file, error))
    data_.assign(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>());
  if (!is_whole_font(data_)) data_.clear();
}

GlyphSheet Font::sheet(int size, const std::vector<char32_t>& characters) const {
  ImFontGlyphRangesBuilder builder;
  builder.AddChar(ImWchar('?'));
  for (const char32_t character : characters) builder.AddChar(ImWchar(character));
  ImVector<ImWchar> ranges;
  builder.BuildRanges(&ranges);
  ImFontAtlas atlas;
  if (built_in() || !rasterize(atlas, data_, size, ranges)) {
    atlas.Clear();
    rasterize(atlas, {}, size, ranges);
  }
  GlyphSheet sheet;
  unsigned char* coverage = nullptr;
  atlas.GetTexDataAsAlpha8(&coverage, &sheet.width, &sheet.height);
  sheet.coverage.assign(coverage, coverage + std::size_t(sheet.width) * std::size_t(sheet.height));
  sheet.solid_u = atlas.TexUvWhitePixel.x;
  sheet.solid_v = atlas.TexUvWhitePixel.y;
  ImFont* font = atlas.Fonts[0];
  const ImFontGlyph* unknown = font->FindGlyphNoFallback(ImWchar('?'));
  for (const char32_t character : characters) {
    const ImFontGlyph* glyph = font->FindGlyphNoFallback(ImWchar(character));
    if (glyph == nullptr) glyph = unknown;
    sheet.glyphs[character] = glyph != nullptr ? glyph_of(*glyph) : GlyphSheet::Glyph{};
  }
  return sheet;
}

}  // namespace souple::render
