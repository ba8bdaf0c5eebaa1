#pragma once

#include "souple/scene/tie_description.h"

namespace souple {

class World;

/// Adds a tie, or the ties of a stitch, to a world that has the tied objects. Throws Error.
void add_tie(const TieDescription& tie, World& world);

}  // namespace souple
