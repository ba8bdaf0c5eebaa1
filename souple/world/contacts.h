#pragma once

#include "souple/contacts/contact_material.h"
#include "souple/objects/object_options.h"
#include "souple/world/state.h"

namespace souple {

ContactMaterial contact_material_of(const ColliderOptions& options);
/// Sets up the contact projectors: object ranges, collision filters, surfaces.
void build_contact_tables(WorldState& world);
/// Updates the particle counts of fluids in the contact projectors.
void update_fluid_counts(WorldState& world);
/// After the solver: shortens motions that would pass through an element.
void keep_apart(WorldState& world, const Substep& substep);
/// Stage (6) for contacts.
void apply_restitution(WorldState& world, const Substep& substep);
/// Fills in the report's contact counts and depth.
void report_contacts(WorldState& world);

}  // namespace souple
