#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace souple::viewer {

/// Colors of the panels, sRGB as 0xRRGGBB.
namespace theme {
inline constexpr unsigned background = 0x16191f, raised = 0x232831, field = 0x2b313c, line = 0x363d49;
inline constexpr unsigned text = 0xe4e8ee, dim = 0x8d97a6, accent = 0x4fb6a8, warm = 0xf0a35e, bad = 0xe8645a;
}  // namespace theme

/// Dear ImGui for the current OpenGL context: theme, font and drawing of panels. Only one may exist at a
/// time.
class Ui {
 public:
  /// `scale` is 1 on an ordinary screen, 2 on one with twice the resolution. Uses the first of `fonts` that
  /// can be read, else ImGui's built-in font.
  explicit Ui(float scale = 1, const std::vector<std::filesystem::path>& fonts = default_fonts());
  ~Ui();
  Ui(const Ui&) = delete;
  Ui& operator=(const Ui&) = delete;

  /// Source of the font: a file, or "built in".
  const std::string& font() const { return font_; }

  static std::vector<std::filesystem::path> default_fonts();
  static void begin();  ///< starts a frame: before any panel, after the window's input
  static void draw();   ///< draws the result of ImGui::Render into the bound framebuffer

 private:
  std::string font_;
};

/// Converts 0xRRGGBB and opacity to ImGui's packed color.
unsigned ui_color(unsigned hex, float alpha = 1);

}  // namespace souple::viewer
