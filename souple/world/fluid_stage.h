#pragma once

#include "souple/world/state.h"

// Connects a world to its fluids' stage (souple/fluid/stage/fluids.h). stages.h declares the rest.

namespace souple {

/// Call after objects are added, removed or changed.
void build_fluids(WorldState& world);
/// Before a step of dt seconds.
void begin_fluids(WorldState& world, double dt);
/// Viscosity and other forces on fluids, after v = (p - x) / h.
void update_fluid_velocities(WorldState& world, const Substep& substep);

}  // namespace souple
