#pragma once

#include "app/view/simulation.h"
#include "render/display.h"
#include "render/renderer.h"

#include <cstddef>
#include <deque>

// Contents of the panel on the left, one file each. A change by the user takes effect immediately; the
// functions throw Error when the world rejects it, and then have changed nothing.

namespace souple::viewer {

void solver_panel(Simulation& simulation);
void forces_panel(Simulation& simulation);
/// Panel of the object selected in it; `chosen` is the object's position in the scene.
void material_panel(Simulation& simulation, std::size_t& chosen);
void timing_panel(const Simulation& simulation);
void numbers_panel(const Simulation& simulation);
void display_panel(render::DisplayOptions& display, render::RenderOptions& rendering, bool& half_resolution,
                   bool has_world, bool has_fluids);

}  // namespace souple::viewer
