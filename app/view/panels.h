#pragma once

#include "app/view/simulation.h"
#include "render/display.h"
#include "render/renderer.h"

#include <cstddef>
#include <deque>

// What stands in the panel on the left, one file for each. A change of the user's acts at once; the functions
// throw Error when the world refuses it, and have then changed nothing.

namespace souple::viewer {

void solver_panel(Simulation& simulation);
void forces_panel(Simulation& simulation);
/// Of the object that is chosen in it; `chosen` is its position in the scene.
void material_panel(Simulation& simulation, std::size_t& chosen);
void timing_panel(const Simulation& simulation);
void numbers_panel(const Simulation& simulation);
void display_panel(render::DisplayOptions& display, render::RenderOptions& rendering, bool& half_resolution,
                   bool has_world, bool has_fluids);

}  // namespace souple::viewer
