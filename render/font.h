#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

namespace souple::render {

/// The code points of a UTF-8 text; invalid bytes and code points above 0xffff become '?'.
std::vector<char32_t> code_points(std::string_view utf8);

/// The characters of one size in one picture.
struct GlyphSheet {
  struct Glyph {
    float x0 = 0, y0 = 0, x1 = 0, y1 = 0;  ///< from the pen at the top of the line, y down [pixels]
    float u0 = 0, v0 = 0, u1 = 0, v1 = 0;  ///< in the picture, in [0, 1]
    float advance = 0;                     ///< of the pen; whole pixels
  };

  int width = 0, height = 0;
  std::vector<std::uint8_t> coverage;  ///< width * height, rows from the top
  /// All requested characters: '?' replaces characters that the font lacks.
  std::map<char32_t, Glyph> glyphs;
  float solid_u = 0, solid_v = 0;  ///< texture coordinates of a fully covered pixel
};

/// A font file; if it cannot be used, the built-in font.
class Font {
 public:
  /// DejaVu Sans, at its path in Debian and most other distributions.
  static std::filesystem::path default_file();

  explicit Font(const std::filesystem::path& file = default_file());

  bool built_in() const { return data_.empty(); }
  /// The whole file, which is a TrueType font; empty for the built-in font.
  std::span<const char> data() const { return data_; }
  /// `size` is the line height [pixels].
  GlyphSheet sheet(int size, const std::vector<char32_t>& characters) const;

 private:
  std::vector<char> data_;
};

}  // namespace souple::render
