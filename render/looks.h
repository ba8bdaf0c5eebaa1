#pragma once

#include "render/draw_list.h"
#include "souple/world/world.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

// What things are made of, to the eye.

namespace souple::render {

/// The look of the index-th object; `chosen` is what a user wants it to be.
Look body_look(ObjectKind kind, std::uint32_t index, const std::optional<Colour>& chosen = {});
/// The same, pale: behind lines that are to be read.
Look pale(const Look& look);
/// Under colours of vertices: they alone have to be seen.
Look measured_look();
Look collider_look(const std::optional<Colour>& chosen = {});
Look pin_look();

/// What a liquid looks like in which light goes about `way` metres: `chosen` is the colour it leaves of white
/// light; else it is that of water, or of oil or honey if it is as light or heavy as they are.
LiquidLook liquid_look(float density, float way, const std::optional<Colour>& chosen = {});
/// The colour of its particles.
Colour liquid_colour(float density, const std::optional<Colour>& chosen = {});

/// Grains differ a little, and each keeps its colour.
std::vector<PackedColour> grain_colours(std::size_t count, std::uint32_t index,
                                        const std::optional<Colour>& chosen = {});

/// (1 - t) a + t b, in linear light.
Colour mix(const Colour& a, const Colour& b, float t);

/// Colours for any number of things, well apart for neighbouring numbers; for lines.
PackedColour distinct_colour(std::uint32_t index);

}  // namespace souple::render
