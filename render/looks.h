#pragma once

#include "render/draw_list.h"
#include "souple/world/world.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

// Appearance of objects.

namespace souple::render {

/// The look of the index-th object; `chosen`: the color set by a user.
Look body_look(ObjectKind kind, std::uint32_t index, const std::optional<Color>& chosen = {});
/// A pale version of the look, as background of lines.
Look pale(const Look& look);
/// A neutral look for vertex colors.
Look measured_look();
Look collider_look(const std::optional<Color>& chosen = {});
Look pin_look();

/// Appearance of a liquid in which light travels about `path` meters. `chosen`: color of white light after
/// that path. By default the color is that of water, or of oil or honey for their densities.
LiquidLook liquid_look(float density, float path, const std::optional<Color>& chosen = {});
/// Color of the liquid's particles.
Color liquid_color(float density, const std::optional<Color>& chosen = {});

/// Colors of grains: slightly different, and constant for each grain.
std::vector<PackedColor> grain_colors(std::size_t count, std::uint32_t index,
                                      const std::optional<Color>& chosen = {});

/// (1 - t) a + t b, in linear light.
Color mix(const Color& a, const Color& b, float t);

/// Colors for any number of lines; neighboring numbers get clearly different colors.
PackedColor distinct_color(std::uint32_t index);

}  // namespace souple::render
