#pragma once

#include "souple/objects/objects_view.h"

// Rotation of grains: Particles::spin from substep to substep, Particles::turn within one, which contacts change.

namespace souple {

/// Rotation of the substep without contacts. Call before contacts are found.
void predict_spin(const ObjectsView& objects, const Substep& substep, Threads& threads);
/// The spin after contacts. Call when restitution has been applied.
void finish_spin(const ObjectsView& objects, const Substep& substep, Threads& threads);

/// Largest speed of an object's surfaces by rotation; 0 unless it consists of grains [m/s].
float fastest_spin(const Particles& particles, const Object& object);

}  // namespace souple
