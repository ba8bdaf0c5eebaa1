#pragma once

#include "souple/contacts/contact.h"
#include "souple/math/vec3.h"
#include "souple/objects/objects_view.h"

#include <cstdint>
#include <vector>

namespace souple {

class Contacts;

/// A soft body at an impact.
struct BodyAtImpact {
  std::uint32_t object = 0;
  double mass = 0;   ///< 0: does not move as a whole [kg]
  Vec3d velocity{};  ///< of the center of mass [m/s]
  Vec3d change{};    ///< by the impacts so far [m/s]
};

/// Impacts of a substep; scratch.
struct BodyImpacts {
  std::vector<Impact> impacts;
  std::vector<BodyAtImpact> bodies;
};

/// Restitution of a soft body as a whole, if the coefficient e exceeds `elastic_restitution`. If the center of mass
/// approaches at the first touch, its velocity along the normal becomes
///   u_n <- e a,   a: approach speed of the contact
/// and the velocity of another soft body at the contact changes so that momentum is conserved. A contact's own
/// restitution (contact_law.h) concerns the particles that touch. They bounce alone against the rest of the body, which
/// still approaches, and their energy is lost. Below `elastic_restitution` the body would be stopped before its
/// elasticity returns the energy, so nothing is done. Call before the restitution of the contacts. `gravity`: its
/// magnitude [m/s^2].
void restitute_bodies(const ObjectsView& objects, const Contacts& contacts, float gravity,
                      const Substep& substep, BodyImpacts& scratch);

}  // namespace souple
