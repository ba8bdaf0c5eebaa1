#pragma once

#include "souple/fluid/fluid_bodies.h"
#include "souple/fluid/sub_resolution_bodies.h"
#include "souple/world/state.h"

#include <optional>
#include <span>
#include <vector>

namespace souple {

/// The boundary mesh of an object for fluids of a spacing [m]; none for objects that are no walls: fluids,
/// ropes, grains.
std::optional<BoundaryMesh> boundary_mesh_of(const Object& object, float spacing);
/// Appends the sub-resolution bodies of a rope or of grains. `mass`: of the world's particles [kg]; `number`:
/// their `object`.
void append_sub_resolution_bodies(const Object& object, float spacing, std::span<const float> mass,
                                  std::uint32_t number, std::vector<SubResolutionBody>& bodies);

}  // namespace souple
