#pragma once

#include "render/draw_list.h"
#include "souple/world/world.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

// Appearance of objects.

namespace souple::render {

/// The look of the index-th object; `chosen` is what a user wants it to be.
Look body_look(ObjectKind kind, std::uint32_t index, const std::optional<Color>& chosen = {});
/// The same, pale: behind lines that are to be read.
Look pale(const Look& look);
/// Under colors of vertices: they alone have to be seen.
Look measured_look();
Look collider_look(const std::optional<Color>& chosen = {});
Look pin_look();

/// What a liquid looks like in which light goes about `way` meters: `chosen` is the color it leaves of white
/// light; else it is that of water, or of oil or honey if it is as light or heavy as they are.
LiquidLook liquid_look(float density, float way, const std::optional<Color>& chosen = {});
/// The color of its particles.
Color liquid_color(float density, const std::optional<Color>& chosen = {});

/// Grains differ a little, and each keeps its color.
std::vector<PackedColor> grain_colors(std::size_t count, std::uint32_t index,
                                      const std::optional<Color>& chosen = {});

/// (1 - t) a + t b, in linear light.
Color mix(const Color& a, const Color& b, float t);

/// Colors for any number of lines; neighboring numbers get clearly different colors.
PackedColor distinct_color(std::uint32_t index);

}  // namespace souple::render
