#include "render/looks.h"

#include "souple/objects/kind_traits.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace souple::render {
namespace {

const Color linen = srgb(0xf4ede0), hemp = srgb(0xe8d9bd);

/// The prints of cloths, by their index in the palette.
constexpr std::array prints{Pattern::checker, Pattern::stripes, Pattern::plaid, Pattern::dots};

/// Hash of an index as a number in [0, 1), equal on every machine. The mixing is that of SplitMix64.
float noise(std::uint64_t index) {
  std::uint64_t z = (index + 1) * 0x9e3779b97f4a7c15u;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return static_cast<float>((z ^ (z >> 31)) >> 40) / static_cast<float>(1 << 24);
}

struct LiquidKind {
  Color left;        // white light after a typical path through the liquid
  Color particles;   // color of particles drawn individually
  float cloudiness;  // approximate fraction of light scattered on that path
  float strength;    // 1 over the length of that path, in halves of the edge of the liquid's cube
  float refractive_index;
};

// Refractive indices: CRC handbook.
const LiquidKind water{srgb(0x6fbfd6), srgb(0x3f8fd0), 0.05f, 1, 1.333f};
const LiquidKind oil{srgb(0xefc94a), srgb(0xd9ae2b), 0.1f, 1, 1.47f};
const LiquidKind honey{srgb(0xf0a526), srgb(0xc07a1a), 0.9f, 2.2f, 1.49f};

const LiquidKind& liquid_kind(float density) {
  if (density > 1200) return honey;
  return density > 0 && density < 960 ? oil : water;
}

Color scaled(const Color& color, float s) {
  return {color.r * s, color.g * s, color.b * s, color.a};
}

}  // namespace

Color mix(const Color& a, const Color& b, float t) {
  return {a.r + (b.r - a.r) * t, a.g + (b.g - a.g) * t, a.b + (b.b - a.b) * t, a.a + (b.a - a.a) * t};
}

Look body_look(ObjectKind kind, std::uint32_t index, const std::optional<Color>& chosen) {
  const Color color = chosen.value_or(palette(index));
  const KindTraits& traits = traits_of(kind);
  if (traits.driven) return collider_look(chosen);
  if (traits.flows) {
    const Color blue = chosen.value_or(water.particles);
    return {.color = blue, .second = blue, .roughness = 0.2f};
  }
  if (traits.rigid) return {.color = color, .second = color, .roughness = 0.35f};
  switch (traits.shape) {
    case ObjectShape::surface:
      return {.color = color,
              .second = mix(color, linen, 0.86f),
              .pattern = prints.at(index % prints.size()),
              .weave = 1,
              .roughness = 0.8f,
              .sheen = 0.4f};
    case ObjectShape::solid:
      return {.color = color, .second = color, .roughness = 0.22f, .translucency = 0.7f};
    case ObjectShape::line:
      return {.color = chosen.value_or(hemp),
              .second = mix(color, hemp, 0.15f),
              .pattern = Pattern::strands,
              .roughness = 0.7f,
              .sheen = 0.2f};
    case ObjectShape::balls:
      break;
  }
  const Color sand = chosen.value_or(srgb(0xd2ab6d));
  return {.color = sand, .second = sand, .roughness = 0.9f};
}

Look finished(const Look& cloth, Fabric fabric, const std::optional<Print>& print) {
  Look look = cloth;
  // The pile of velvet swallows light that falls along it, and scatters light at grazing angles.
  if (fabric == Fabric::velvet) {
    look.roughness = look.sheen = 1;
    look.weave = 0.1f;
    look.color = scaled(look.color, 0.6f);
    look.second = scaled(look.second, 0.6f);
  }
  if (fabric == Fabric::satin)
    look.roughness = 0.3f, look.sheen = 0, look.metalness = 0.4f, look.weave = 0.1f;
  if (!print && fabric == Fabric::woven) return look;
  const Print chosen = print.value_or(Print::plain);
  if (chosen == Print::plain) {
    look.second = look.color;
    return look;
  }
  constexpr std::array patterns{Pattern::checker, Pattern::checker, Pattern::stripes, Pattern::plaid,
                                Pattern::dots};
  look.pattern = patterns.at(static_cast<std::size_t>(chosen));
  return look;
}

LiquidLook liquid_look(float density, float path_length, const std::optional<Color>& chosen) {
  const LiquidKind& kind = liquid_kind(density);
  const Color left = chosen.value_or(kind.left);
  LiquidLook look;
  look.absorption = absorption_of(left, path_length / kind.strength);
  look.scattering = Vec3f{left.r, left.g, left.b} * (kind.cloudiness * kind.strength / path_length);
  look.refractive_index = kind.refractive_index;
  return look;
}

Color liquid_color(float density, const std::optional<Color>& chosen) {
  return chosen.value_or(liquid_kind(density).particles);
}

Look pale(const Look& look) {
  Look result = measured_look();
  result.color = result.second = mix(srgb(0xc6cbd0), look.color, 0.2f);
  return result;
}

Look measured_look() {
  return {.color = srgb(0xc4c8cc), .second = srgb(0xc4c8cc), .roughness = 0.75f};
}

Look collider_look(const std::optional<Color>& chosen) {
  const Color color = chosen.value_or(srgb(0xcfd1d3));
  return {.color = color, .second = color, .roughness = 0.6f};
}

std::pair<Color, Color> floor_colors(const std::optional<Color>& chosen) {
  if (!chosen) return {Ground().color, Ground().second};
  const auto times = [&](float factor) {
    return Color{std::min(chosen->r * factor, 1.0f), std::min(chosen->g * factor, 1.0f),
                 std::min(chosen->b * factor, 1.0f)};
  };
  return {times(1.3f), times(0.7f)};
}

Look glass_look(const std::optional<Color>& chosen) {
  const Color tint = mix(chosen.value_or(srgb(0xd8ece6)), {1, 1, 1}, 0.75f);
  return {.color = tint, .second = tint, .roughness = 0.2f, .glass = true};
}

Look pin_look() {
  return {.color = srgb(0xd8a23c), .second = srgb(0xd8a23c), .roughness = 0.3f, .metalness = 0.9f};
}

std::vector<PackedColor> grain_colors(std::size_t count, std::uint32_t index,
                                      const std::optional<Color>& chosen) {
  static constexpr std::array<std::uint32_t, 6> sand{0xd9b679, 0xc79d5e, 0xe8cf9c,
                                                     0xb68a55, 0xf0dfb6, 0xcfa872};
  const Color tint = chosen.value_or(palette(index));
  const float strength = chosen ? 0.8f : 0.08f;
  std::vector<PackedColor> result(count);
  for (std::size_t i = 0; i < count; ++i) {
    const Color color = srgb(sand[static_cast<std::size_t>(noise(2 * i) * sand.size()) % sand.size()]);
    result[i] = pack(scaled(mix(color, tint, strength), 0.85f + 0.3f * noise(2 * i + 1)));
  }
  return result;
}

PackedColor distinct_color(std::uint32_t index) {
  // Hues at multiples of the golden angle, in three lightnesses.
  const float hue = std::fmod(static_cast<float>(index) * 0.61803399f, 1.0f) * 6;
  const float light = 0.55f + 0.2f * static_cast<float>(index % 3);
  const auto channel = [&](float shift) {
    const float place = std::abs(std::fmod(hue + shift, 6.0f) - 3) - 1;
    const float pure = place < 0 ? 0.0f : (place > 1 ? 1.0f : place);
    return light * (0.15f + 0.85f * pure);
  };
  return pack({channel(0), channel(4), channel(2), 1});
}

}  // namespace souple::render
