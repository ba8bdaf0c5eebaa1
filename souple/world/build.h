#pragma once

#include "souple/world/state.h"

namespace souple {

/// Rebuilds the objects' constraint projectors (distances, bending, tets, pressure, ...). They are a pure
/// function of the objects: adding and removing an object leaves no trace. Kinds are solved in the order of
/// this function's body, constraints of one kind in the order of their objects.
void build_constraints(WorldState& world);

/// Throws Error, beginning with the object's name, if its constraints cannot be built. Returns the number of
/// cloth elements that are too thin for bending or a membrane and are skipped.
std::size_t check_constraints(const Object& object);

/// Per particle: half the object's thickness, the radius of a grain or rope, or a quarter of a fluid's
/// spacing; times the thickness map, minus the embedding offset.
void build_contact_radii(WorldState& world);

}  // namespace souple
