#pragma once

#include "souple/world/state.h"

// The stages of the loop: one function each, over the state of a world. World::step calls them in order.

namespace souple {

/// Once per step: finds contact candidates for the next dt seconds.
void find_candidates(WorldState& world, double dt);

/// Once per step: finds what is free to spin.
void begin_angular_momentum(WorldState& world);

/// (1) v* and p* from external forces, by the integrator of the settings. Moves pinned particles to their
/// targets, obstacles along their motion, and attachments' targets.
void integrate(WorldState& world, const Substep& substep);

/// Call after fluids are added, removed or changed.
void build_fluids(WorldState& world);
/// Once per step of dt seconds, before its stages.
void begin_fluids(WorldState& world, double dt);
/// (2) Moves fluid particles until no fluid is compressed.
void solve_incompressibility(WorldState& world, const Substep& substep);

/// Once per step, after its substeps: spray, foam and bubbles from `time` on for dt seconds.
void step_foam(WorldState& world, double time, double dt);

/// (3) Generates contacts along x -> p.
void generate_contacts(WorldState& world, const Substep& substep);

/// (4) Projects every constraint, `iterations` times: by kind and color, contacts last. Then shortens motions
/// that would still pass through an element.
void solve(WorldState& world, const Substep& substep);

/// (5) v = v* + (p - p*) / h, which is (p - x) / h if p* = x + h v*; x = p. Returns false if a value is
/// non-finite.
bool finish(WorldState& world, const Substep& substep);

/// (6) Restitution, damping, viscosity. Returns false if a value is non-finite after the last substep.
bool update_velocities(WorldState& world, const Substep& substep);
/// Its part for fluids.
void update_fluid_velocities(WorldState& world, const Substep& substep);

}  // namespace souple
