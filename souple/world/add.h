#pragma once

#include "souple/world/state.h"

namespace souple {

/// kg/m^2 of a cloth, kg/m^3 of the others.
float density(const Material& material);
/// Half the thickness, or the radius of grains and ropes. [m]
float contact_radius(const Material& material);
/// Multiplies the masses of an object's particles.
void scale_mass(WorldState& world, const Object& object, float factor);
/// Drops an object, its particles, and every constraint that names one of them.
void remove_object(WorldState& world, const Object& object);
/// The particles (within the object) that carry these user vertices, ascending: themselves, or the corners of
/// the tets they are embedded in.
std::vector<std::uint32_t> particles_of(const Object& object, const std::vector<std::uint32_t>& vertices);
/// Throws Error for an obstacle: nothing but its motion says where it goes. `what` names the function.
void require_movable(const Object& object, const char* what);
/// Throws Error for a fluid: its particles come and go, so no constraint can name one. `what` as before.
void require_permanent_particles(const Object& object, const char* what);
/// Throws Error when it is no layer, or the object has no surface that could be one.
void require_layer(const Object& object, int layer);

}  // namespace souple
