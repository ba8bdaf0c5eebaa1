#pragma once

#include "souple/world/state.h"

namespace souple {

/// Multiplies the masses of an object's particles.
void scale_mass(WorldState& world, const Object& object, float factor);
/// Removes the particles of ranges, ascending, each of one object or of some that follow each other, and every constraint on
/// one of them.
void erase_particles(WorldState& world, std::span<const IndexRange> ranges);
/// The particles (within the object) that move these user vertices, ascending. They are the vertices' own particles, or
/// the corners of the tets in which they are embedded.
std::vector<std::uint32_t> particles_of(const Object& object, const std::vector<std::uint32_t>& vertices);
/// Throws Error for an obstacle: only its motion moves it. `what` names the calling function.
void require_movable(const Object& object, const char* what);
/// Throws Error for a fluid: its particles come and go, so no constraint can refer to one. `what` names the
/// calling function.
void require_permanent_particles(const Object& object, const char* what);

}  // namespace souple
