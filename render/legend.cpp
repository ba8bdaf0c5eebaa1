#include "render/legend.h"

#include "render/looks.h"

#include <cmath>
#include <utility>

#include <fmt/core.h>

namespace souple::render {
namespace {

constexpr float margin = 14, line_height = 22, text_size = 15;  // pixels

/// Black or white, the one with more contrast.
Color ink_on(const Color& background) {
  const float luminance = 0.2126f * background.r + 0.7152f * background.g + 0.0722f * background.b;
  return luminance > 0.2f ? srgb(0x101418) : srgb(0xffffff);
}

}  // namespace

void Legend::add(std::string text, const Color& color, const Color& background) {
  labels_.push_back({.text = " " + std::move(text) + " ",
                     .x = margin,
                     .y = margin + line_height * static_cast<float>(labels_.size()),
                     .size = text_size,
                     .color = color,
                     .background = background});
}

void Legend::title(std::string text) {
  add(std::move(text), srgb(0xffffff), srgb(0x20262c, 0.8f));
}

void Legend::entry(PackedColor color, std::string text) {
  Color background = unpack(color);
  background.a = 1;
  add(std::move(text), ink_on(background), background);
}

void Legend::scale(const HeatScale& heat, float largest, const std::string& unit) {
  constexpr int steps = 4;
  for (int i = steps; i >= 0; --i) {
    const float t = static_cast<float>(i) / steps;
    entry(heat(t), short_number(static_cast<double>(t * largest)) + " " + unit);
  }
}

Color unpack(PackedColor color) {
  Color result = srgb((color & 0xff) << 16 | (color & 0xff00) | (color >> 16 & 0xff));
  result.a = static_cast<float>(color >> 24) / 255;
  return result;
}

std::string short_number(double value) {
  const double size = std::abs(value);
  if (size != 0 && (size < 1e-3 || size >= 1e6)) return fmt::format("{:.1e}", value);
  if (size < 1000) return fmt::format("{:.3g}", value);
  // {:g} would write 123000 as 1.23e+05.
  const double rounding = std::pow(10, std::floor(std::log10(size)) - 2);
  return fmt::format("{:.0f}", std::round(value / rounding) * rounding);
}

}  // namespace souple::render
