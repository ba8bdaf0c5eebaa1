#pragma once

#include "souple/objects/joint_options.h"
#include "souple/world/state.h"

namespace souple {

/// Removes all joints of an object or collider.
void remove_joints_of(WorldState& world, const JointSide& side);
/// After a step: counts joints that broke, and logs them.
void report_joints(WorldState& world);

}  // namespace souple
