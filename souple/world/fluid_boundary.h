#pragma once

#include "souple/fluid/fluid_bodies.h"
#include "souple/fluid/sub_resolution_bodies.h"
#include "souple/world/state.h"

#include <optional>
#include <span>
#include <vector>

namespace souple {

/// How fluids of a spacing [m] feel an object; nothing for what is no wall to them: other fluids, ropes,
/// grains.
std::optional<BoundaryMesh> boundary_mesh_of(const Object& object, float spacing);
/// Appends the pieces of a rope or of grains; `mass` of the world's particles [kg], `number`:
/// SubResolutionBody::object.
void append_sub_resolution_bodies(const Object& object, float spacing, std::span<const float> mass,
                                  std::uint32_t number, std::vector<SubResolutionBody>& bodies);

}  // namespace souple
