#pragma once

#include "souple/world/state.h"

namespace souple {

/// Makes the standard projectors (distances, bending, tets, pressure, ...) anew from the objects: they are a
/// pure function of them, so a world to which objects were added and removed is the same as one that never
/// had them. Kinds are solved in the order of this function's body; constraints of one kind in order of their
/// objects.
void build_constraints(WorldState& world);

/// Throws Error, beginning with its name, when this object's constraints cannot be built. Returns how many
/// elements of a cloth are too thin to carry bending or a membrane and are left out.
std::size_t check_constraints(const Object& object);

/// Per particle: half the object's thickness, or the radius of a grain or rope.
void build_contact_radii(WorldState& world);

}  // namespace souple
