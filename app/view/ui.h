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

/// Dear ImGui for the current OpenGL context: theme, font, drawing of panels. Only one instance may exist.
class Ui {
 public:
  /// `scale`: 1 on an ordinary screen, 2 on one of double resolution. Uses the first readable one of `fonts`,
  /// else ImGui's own.
  explicit Ui(float scale = 1, const std::vector<std::filesystem::path>& fonts = usual_fonts());
  ~Ui();
  Ui(const Ui&) = delete;
  Ui& operator=(const Ui&) = delete;

  /// The font file, or "built in".
  const std::string& font() const { return font_; }

  static std::vector<std::filesystem::path> usual_fonts();
  static void begin();  ///< begins a frame: call after the window's input and before the panels
  static void draw();   ///< draws the output of ImGui::Render into the bound framebuffer

 private:
  std::string font_;
};

/// Converts 0xRRGGBB and opacity to ImGui's packed format.
unsigned ui_color(unsigned hex, float alpha = 1);

}  // namespace souple::viewer
