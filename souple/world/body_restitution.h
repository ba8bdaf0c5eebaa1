#pragma once

#include "souple/world/state.h"

namespace souple {

/// Restitution of a soft body as a whole, where the coefficient e exceeds `elastic_restitution`. Where the center of mass
/// approaches at the first touch, its velocity along the normal becomes
///   u_n <- e a,   a: approach speed of the contact
/// and that of another soft body at the contact changes so that momentum is conserved. A contact's own restitution
/// (contact_law.h) concerns the particles that touch: they bounce alone, against the rest of the body that still
/// approaches, and their energy is lost. Below `elastic_restitution` the body would be stopped before its elasticity returns
/// the energy, so nothing is done. Call before the restitution of the contacts.
void restitute_bodies(WorldState& world, const Substep& substep);

}  // namespace souple
