#pragma once

#include "souple/world/state.h"

// The stages of the loop, one function each, over the state of a world. World::step calls them in order.

namespace souple {

/// Once a step: which particles may meet which colliders and each other within dt seconds.
void find_candidates(WorldState& world, double dt);

/// (1) v* and p* from external forces, by the integrator of the settings; pinned particles go to their
/// targets.
void integrate(WorldState& world, const Substep& substep);

/// (2) Fluids are pushed apart until they are not compressed.
void solve_incompressibility(WorldState& world, const Substep& substep);

/// Once a step, after its substeps: spray, foam and bubbles, from `time` on for dt seconds.
void step_foam(WorldState& world, double time, double dt);

/// (3) Contacts along x -> p.
void generate_contacts(WorldState& world, const Substep& substep);

/// (4) Projects every constraint, `iterations` times: kind after kind, color after color, contacts last;
/// then shortens the ways of what would still pass through something.
void solve(WorldState& world, const Substep& substep);

/// (5) v = v* + (p - p*) / h, which is (p - x) / h when p* = x + h v*; x = p. False when a number went bad.
bool finish(WorldState& world, const Substep& substep);

/// (6) Restitution, damping, viscosity.
void update_velocities(WorldState& world, const Substep& substep);

}  // namespace souple
