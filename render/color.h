#pragma once

#include <cstdint>

namespace souple::render {

/// Linear light, Rec. 709 primaries; alpha is coverage. Shaders work only in this encoding.
struct Color {
  float r = 0, g = 0, b = 0, a = 1;
  friend bool operator==(const Color&, const Color&) = default;
};

/// Converts 0xRRGGBB (sRGB) to linear light.
Color srgb(std::uint32_t hex, float alpha = 1);

/// sRGB-encoded R, G, B and linear alpha in four bytes, R lowest: the color of a vertex, line or sphere.
using PackedColor = std::uint32_t;
PackedColor pack(const Color& color);

/// The color of value t in [0, 1] on a scale from dark blue to yellow, whose order survives grayscale and
/// color blindness. Values outside are clamped; NaN is magenta.
Color heat(float t);

/// Clearly different colors for objects 0, 1, 2, ...; they repeat after 8.
Color palette(std::uint32_t index);

}  // namespace souple::render
