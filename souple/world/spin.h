#pragma once

#include "souple/solver/projector.h"
#include "souple/world/state.h"

// Rotation of grains: Particles::spin from substep to substep, Particles::turn within one, which contacts change.

namespace souple {

/// Rotation of the substep without contacts. Call before contacts are found.
void predict_spin(WorldState& world, const Substep& substep);
/// The spin after contacts. Call when restitution has been applied.
void finish_spin(WorldState& world, const Substep& substep);

/// Largest speed of an object's surfaces by rotation; 0 unless it consists of grains [m/s].
float fastest_spin(const WorldState& world, const Object& object);

}  // namespace souple
