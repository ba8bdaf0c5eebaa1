#pragma once

#include "render/draw_list.h"
#include "render/subject.h"
#include "souple/world/world.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

// Appearance of objects.

namespace souple::render {

/// The look of the object with this index; `chosen` is the color from the scene.
Look body_look(ObjectKind kind, std::uint32_t index, const std::optional<Color>& chosen = {});
/// A cloth's look in this fabric, with this print.
Look finished(const Look& cloth, Fabric fabric, const std::optional<Print>& print);
/// A paler look, for objects behind lines.
Look pale(const Look& look);
/// For objects with colors per vertex: a neutral look, so that only these colors show.
Look measured_look();
Look collider_look(const std::optional<Color>& chosen = {});
/// The two ends of the floor's colors, whose mean is `chosen`; concrete without it.
std::pair<Color, Color> floor_colors(const std::optional<Color>& chosen = {});
/// `chosen` tints the glass.
Look glass_look(const std::optional<Color>& chosen = {});
Look pin_look();

/// The look of a liquid through which light travels about `path_length` meters. `chosen` is the color of
/// white light after that path. Without it: the look of water, or of oil or honey for densities like theirs.
LiquidLook liquid_look(float density, float path_length, const std::optional<Color>& chosen = {});
/// The color of a liquid's particles.
Color liquid_color(float density, const std::optional<Color>& chosen = {});

/// Colors that differ a little between grains; each grain keeps its color.
std::vector<PackedColor> grain_colors(std::size_t count, std::uint32_t index,
                                      const std::optional<Color>& chosen = {});

/// (1 - t) a + t b, in linear light.
Color mix(const Color& a, const Color& b, float t);

/// Colors for any number of lines; consecutive numbers get clearly different colors.
PackedColor distinct_color(std::uint32_t index);

}  // namespace souple::render
