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

/// Dear ImGui for the OpenGL context that is current: theme, font, the drawing of panels. One at a time.
class Ui {
 public:
  /// `scale` is 1 on an ordinary screen, 2 where everything is twice as fine. The first of `fonts` that can
  /// be read is taken, else ImGui's own.
  explicit Ui(float scale = 1, const std::vector<std::filesystem::path>& fonts = usual_fonts());
  ~Ui();
  Ui(const Ui&) = delete;
  Ui& operator=(const Ui&) = delete;

  /// Where the letters come from: a file, or "built in".
  const std::string& font() const { return font_; }

  static std::vector<std::filesystem::path> usual_fonts();
  static void begin();  ///< a picture: before any panel, after the window's input
  static void draw();   ///< what ImGui::Render left, into the framebuffer that is bound

 private:
  std::string font_;
};

/// 0xRRGGBB and opacity to ImGui's packing.
unsigned ui_color(unsigned hex, float alpha = 1);

}  // namespace souple::viewer
