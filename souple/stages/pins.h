#pragma once

#include "souple/objects/callbacks.h"
#include "souple/stages/stage_view.h"

#include <cstdint>
#include <string_view>

namespace souple {

/// The target's position of a vertex [m]. Throws Error, with the vertex and its object, if it is not finite.
Vec3d target_at(const Target& target, std::uint32_t vertex, double time, std::string_view object = {});

/// Moves pinned particles to target(vertex, t + h) + offset, or along their path to the place where they arrive at the
/// end of the step; others stay. `part`: part of the step that has passed at the end of the substep; 1 in the last one.
void drive_pins(const StageView& stage, const Substep& substep, double part);

}  // namespace souple
