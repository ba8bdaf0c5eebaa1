#pragma once

#include <cstdint>

namespace souple::render {

/// Linear light, Rec. 709 primaries; alpha is coverage. Shaders receive no other encoding.
struct Color {
  float r = 0, g = 0, b = 0, a = 1;
  friend bool operator==(const Color&, const Color&) = default;
};

/// Converts 0xRRGGBB, as designers write it (sRGB), to linear light.
Color srgb(std::uint32_t hex, float alpha = 1);

/// Four bytes, sRGB-encoded R, G, B and linear alpha, R in the lowest byte: colors per vertex, line, sphere.
using PackedColor = std::uint32_t;
PackedColor pack(const Color& color);

/// The color of a value t in [0, 1] on a scale whose order remains visible in grayscale and for the
/// color-blind (dark blue to yellow). Other values are clamped; NaN is magenta.
Color heat(float t);

/// Clearly distinguishable colors for objects 0, 1, 2, ...; they repeat after 8.
Color palette(std::uint32_t index);

}  // namespace souple::render
