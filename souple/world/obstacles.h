#pragma once

#include "souple/objects/obstacle_motion.h"
#include "souple/world/state.h"

#include <string_view>
#include <vector>

// Obstacles: meshes with prescribed motion. Their particles have no mass; no force or contact moves them.

namespace souple {

/// Throws Error if a sequence has another vertex count, non-finite values or times that do not increase.
void validate(const ObstacleMotion& motion, std::size_t vertices, std::string_view owner);

/// Positions of an obstacle's particles at `time` [s]. Passes exceptions of callbacks on.
std::vector<Vec3d> obstacle_positions(const Object& object, double time);

bool is_static(const ObstacleMotion& motion);

/// Sets the obstacles' velocities to their mean velocities over the next dt seconds, for the search of near
/// pairs.
void predict_obstacles(WorldState& world, double dt);

/// Moves the particles of obstacles to their positions at the end of the substep.
void drive_obstacles(WorldState& world, const Substep& substep);

}  // namespace souple
