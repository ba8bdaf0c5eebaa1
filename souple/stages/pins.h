#pragma once

#include "souple/stages/stage_view.h"

namespace souple {

/// Moves pinned particles to target(vertex, t + h) + offset, or along their path to the place where they arrive at the
/// end of the step; others stay. `part`: part of the step that has passed at the end of the substep; 1 in the last one.
void drive_pins(const StageView& stage, const Substep& substep, double part);

}  // namespace souple
