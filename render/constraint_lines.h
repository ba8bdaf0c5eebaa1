#pragma once

#include "render/display.h"
#include "render/legend.h"
#include "souple/world/world.h"

#include <vector>

namespace souple::render {

/// The color for constraints of a kind.
PackedColor kind_color(std::string_view kind);

/// Draws every constraint of a world as lines and lists their colors in `legend`. Two particles are a segment, three a
/// triangle, four a hinge across its edge or a tet. One particle is a cross, any other number a star. `size` is the
/// size of crosses [m].
void draw_constraints(const World& world, const DisplayOptions& options, const HeatScale& heat, float size,
                      std::vector<Line>& lines, Legend& legend);

}  // namespace souple::render
