#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string_view>
#include <vector>

namespace souple::render {

/// The code points of a UTF-8 text; invalid bytes and code points above 0xffff become '?'.
std::vector<char32_t> code_points(std::string_view utf8);

/// The characters of one size in a common picture.
struct GlyphSheet {
  struct Glyph {
    float x0 = 0, y0 = 0, x1 = 0, y1 = 0;  ///< from the pen at the top of the line, y down [pixels]
    float u0 = 0, v0 = 0, u1 = 0, v1 = 0;  ///< in the picture, in [0, 1]
    float advance = 0;                     ///< motion of the pen [whole pixels]
  };

  int width = 0, height = 0;
  std::vector<std::uint8_t> coverage;  ///< width * height, rows from the top
  /// The glyph of every requested character; '?' replaces missing ones.
  std::map<char32_t, Glyph> glyphs;
  float solid_u = 0, solid_v = 0;  ///< a point of the picture with full coverage
};

/// A font file, or the built-in font if the file cannot be used.
class Font {
 public:
  /// DejaVu Sans at its path in Debian and most other distributions.
  static std::filesystem::path usual_file();

  explicit Font(const std::filesystem::path& file = usual_file());

  bool built_in() const { return data_.empty(); }
  /// `size` is the height of a line [pixels].
  GlyphSheet sheet(int size, const std::vector<char32_t>& characters) const;

 private:
  std::vector<char> data_;
};

}  // namespace souple::render
