#pragma once

#include "souple/objects/materials.h"
#include "souple/world/state.h"

namespace souple {

/// Gives an object another material of its kind, and builds the constraints that change with it. If it throws, nothing
/// has changed.
void replace_material(WorldState& world, Object& object, const Material& material);

/// Takes over the constraints that objects have built since the last call, and removes those of objects that are gone.
/// The result is a pure function of the objects, bit for bit: neither an object that was removed nor another material
/// leaves a trace. Kinds are solved in the order of SetKind, then shape matching and enclosed volumes. Constraints of
/// one kind are solved in the order of their colors and objects. Returns false if only values changed, not which
/// particles constraints link.
bool build_constraints(WorldState& world);

/// The contact radius of each particle, see find_contact_radii.
void build_contact_radii(WorldState& world);

}  // namespace souple
