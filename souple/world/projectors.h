#pragma once

#include "souple/stages/user_constraint.h"
#include "souple/world/contact_state.h"
#include "souple/world/state.h"

namespace souple {

/// Calls f(projector) for all projectors except contacts, in order of solution: objects' constraints, user constraints.
template <class Function>
void for_each_constraint_projector(const WorldState& world, const Function& f) {
  for (Projector* const projector : world.constraints.object_projectors) f(*projector);
  for (const UserConstraint& user_constraint : world.constraints.users)
    if (user_constraint.is_active) f(*user_constraint.projector);
}

/// Calls f for all projectors, contacts last.
template <class Function>
void for_each_projector(const WorldState& world, const Function& f) {
  for_each_constraint_projector(world, f);
  for (const auto& kind : world.contact->contacts.kinds()) f(*kind);
}

}  // namespace souple
