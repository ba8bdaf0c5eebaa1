#pragma once

#include "souple/world/state.h"

// Obstacles: meshes with prescribed motion. Their particles have no mass; no force or contact moves them.

namespace souple {

/// Sets the obstacles' velocities to their mean velocities over the next dt seconds, for the search of near
/// pairs.
void predict_obstacles(WorldState& world, double dt);

/// Moves the particles of obstacles to their positions at the end of the substep.
void drive_obstacles(WorldState& world, const Substep& substep);

}  // namespace souple
