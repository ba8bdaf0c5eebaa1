#pragma once

#include <cstdint>

namespace souple::render {

/// Linear light, Rec. 709 primaries; alpha is coverage. A shader never sees any other encoding.
struct Colour {
  float r = 0, g = 0, b = 0, a = 1;
  friend bool operator==(const Colour&, const Colour&) = default;
};

/// 0xRRGGBB as designers write it (sRGB) to linear light.
Colour srgb(std::uint32_t hex, float alpha = 1);

/// Four bytes, sRGB-encoded R, G, B and linear alpha, R in the lowest byte: colours per vertex, line, sphere.
using PackedColour = std::uint32_t;
PackedColour pack(const Colour& colour);

/// The colour of value t in [0, 1] on a scale that keeps its order in greyscale and for the colour-blind
/// (dark blue to yellow). Values outside are clamped; NaN is magenta.
Colour heat(float t);

/// Well told apart colours for objects 0, 1, 2, ...; they repeat after 8.
Colour palette(std::uint32_t index);

}  // namespace souple::render
