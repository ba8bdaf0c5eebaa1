#pragma once

#include "souple/stages/stage_view.h"

// Obstacles: meshes with prescribed motion. Their particles have no mass; no force or contact moves them.

namespace souple {

/// Sets the obstacles' velocities to their mean velocities over the next dt seconds, for the search of near
/// pairs.
void predict_obstacles(const StageView& stage, double dt);

/// Moves the particles of obstacles to their positions at the end of the substep. Returns whether one jumped there
/// without continuous motion.
bool drive_obstacles(const StageView& stage, const Substep& substep);

}  // namespace souple
