#pragma once

#include "souple/world/state.h"

namespace souple {

/// What has no triangles and is no rope is a cloud of balls: grains, and bodies whose surface is embedded in
/// a lattice.
bool is_particle_only(const Object& object);
/// Tells the contact projectors what there is: object ranges, which of them meet, surfaces.
void build_contact_tables(WorldState& world);
/// Tells them how many particles fluids have by now.
void update_fluid_counts(WorldState& world);
/// After the solver: shortens what would pass through something.
void keep_apart(WorldState& world, const Substep& substep);
/// Stage (6) at contacts.
void apply_restitution(WorldState& world, const Substep& substep);
/// Fills the report's counts.
void report_contacts(WorldState& world);

}  // namespace souple
