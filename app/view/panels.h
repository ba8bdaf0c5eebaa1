#pragma once

#include "app/view/simulation.h"
#include "render/display.h"
#include "render/renderer.h"

#include <cstddef>
#include <deque>

// Sections of the panel on the left, one file each. User changes act immediately. The functions throw Error
// if the world rejects a change, and then change nothing.

namespace souple::viewer {

void solver_panel(Simulation& simulation);
void forces_panel(Simulation& simulation);
/// Material of the chosen object; `chosen` is its index in the scene.
void material_panel(Simulation& simulation, std::size_t& chosen);
void timing_panel(const Simulation& simulation);
void numbers_panel(const Simulation& simulation);
void display_panel(render::DisplayOptions& display, render::RenderOptions& rendering, bool& half_resolution,
                   bool has_world, bool has_fluids);

}  // namespace souple::viewer
