#pragma once

#include "souple/world/state.h"

namespace souple {

/// Multiplies the masses of an object's particles.
void scale_mass(WorldState& world, const Object& object, float factor);
/// Removes the particles [begin, end) of an object, and every constraint on one of them.
void erase_particles(WorldState& world, std::uint32_t begin, std::uint32_t end);
/// Removes an object, its particles, and every constraint on one of them.
void remove_object(WorldState& world, const Object& object);
/// The particles (within the object) that move these user vertices, ascending. They are the vertices' own particles, or
/// the corners of the tets in which they are embedded.
std::vector<std::uint32_t> particles_of(const Object& object, const std::vector<std::uint32_t>& vertices);
/// Throws Error for an obstacle: only its motion moves it. `what` names the calling function.
void require_movable(const Object& object, const char* what);
/// Throws Error for a fluid: its particles come and go, so no constraint can refer to one. `what` names the
/// calling function.
void require_permanent_particles(const Object& object, const char* what);

}  // namespace souple
