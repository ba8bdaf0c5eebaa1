#pragma once

#include "souple/world/state.h"

namespace souple {

/// Damps the non-rigid motion of an object by its material's `damping` rate [1/s]:
///   v_i += k (v_cm + omega x r_i - v_i),  k = 1 - exp(-damping h)     (Müller et al. 2007, section 3.5)
/// Conserves linear and angular momentum. Pinned particles are excluded. Grains are not damped.
void damp(WorldState& world, const Object& object, float h);

}  // namespace souple
