#pragma once

#include "souple/scene/joint_description.h"
#include "souple/scene/tie_description.h"

namespace souple {

class World;

/// Adds a joint to a world that has the joined bodies. Throws Error.
void add_joint(const AnyJointDescription& joint, World& world);

/// Adds a tie, or the ties of a stitch, to a world that has the tied objects. Throws Error.
void add_tie(const TieDescription& tie, World& world);

}  // namespace souple
