#pragma once

#include "souple/world/state.h"

namespace souple {

/// Damps the motion of an object that is not the motion of a rigid body, by its material's `damping` rate
/// [1/s]:
///   v_i += k (v_cm + omega x r_i - v_i),  k = 1 - exp(-damping h)     (Müller et al. 2007, section 3.5)
/// Linear and angular momentum are conserved. Pinned particles neither count nor change.
void damp(WorldState& world, const Object& object, float h);

}  // namespace souple
