#pragma once

#include "souple/world/state.h"

#include <string_view>
#include <vector>

// Meshes that go where they are told. Their particles have no mass; nothing else moves them.

namespace souple {

/// Throws Error when a sequence is not of `vertices`, or holds what is no number or goes back in time.
void validate(const ObstacleMotion& motion, std::size_t vertices, std::string_view owner);

/// Where the particles of an obstacle are at `time` [s]; passes on what a callback throws.
std::vector<Vec3d> obstacle_positions(const Object& object, double time);

bool is_static(const ObstacleMotion& motion);

/// Velocities that take obstacles through the next dt seconds: near pairs are found by them.
void predict_obstacles(WorldState& world, double dt);

/// Leads the particles of obstacles to where they are at the end of the substep.
void drive_obstacles(WorldState& world, const Substep& substep);

}  // namespace souple
