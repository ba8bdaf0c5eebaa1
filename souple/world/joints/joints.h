#pragma once

#include "souple/objects/joint_options.h"
#include "souple/world/state.h"

#include <functional>

namespace souple {

/// Removes the joints with a side of which `holds` is true.
void remove_joints_if(WorldState& world, const std::function<bool(const JointSide&)>& holds);
/// After a step: counts joints that broke, and logs them.
void report_joints(WorldState& world);

}  // namespace souple
