#pragma once

#include "souple/scene/joint_description.h"

namespace souple {

class World;

/// Adds a joint to a world that has the joined bodies. Throws Error.
void add_joint(const AnyJointDescription& joint, World& world);

}  // namespace souple
