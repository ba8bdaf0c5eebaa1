#include "render/color.h"

#include "render/srgb.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace souple::render {

namespace {

std::uint32_t byte_of(float value) {
  return std::uint32_t(std::lround(std::clamp(value, 0.0f, 1.0f) * 255));
}

}  // namespace

float linear_of_srgb(float encoded) {
  return encoded <= 0.04045f ? encoded / 12.92f : std::pow((encoded + 0.055f) / 1.055f, 2.4f);
}

float srgb_of_linear(float linear) {
  return linear <= 0.0031308f ? linear * 12.92f : 1.055f * std::pow(linear, 1 / 2.4f) - 0.055f;
}

Color srgb(std::uint32_t hex, float alpha) {
  const auto channel = [&](int shift) { return linear_of_srgb(float((hex >> shift) & 0xff) / 255); };
  return {channel(16), channel(8), channel(0), alpha};
}

PackedColor pack(const Color& color) {
  const auto encoded = [](float linear) { return byte_of(srgb_of_linear(std::clamp(linear, 0.0f, 1.0f))); };
  return encoded(color.r) | encoded(color.g) << 8 | encoded(color.b) << 16 | byte_of(color.a) << 24;
}

Color heat(float t) {
  // matplotlib's "plasma" at tenths: its lightness increases evenly, and its order remains visible with
  // red-green blindness.
  static constexpr std::array<std::uint32_t, 10> stops{0x0d0887, 0x47039f, 0x7301a8, 0x9c179e, 0xbd3786,
                                                       0xd8576b, 0xed7953, 0xfa9e3b, 0xfdc926, 0xf0f921};
  if (std::isnan(t)) return srgb(0xff00ff);
  const float place = std::clamp(t, 0.0f, 1.0f) * float(stops.size() - 1);
  const std::size_t i = std::min(std::size_t(place), stops.size() - 2);
  const float part = place - float(i);
  // Perceptually even steps: interpolated between encoded values, not linear ones.
  const auto channel = [&](int shift) {
    const auto value = [&](std::uint32_t hex) { return float((hex >> shift) & 0xff) / 255; };
    return linear_of_srgb(value(stops[i]) * (1 - part) + value(stops[i + 1]) * part);
  };
  return {channel(16), channel(8), channel(0), 1};
}

Color palette(std::uint32_t index) {
  static constexpr std::array<std::uint32_t, 8> colors{0x4e79a7, 0xf28e2b, 0x59a14f, 0xe15759,
                                                       0x76b7b2, 0xedc948, 0xb07aa1, 0xd37295};
  return srgb(colors[index % colors.size()]);
}

}  // namespace souple::render
