#pragma once

#include "souple/fluid/emitter_record.h"

#include <cstdint>

// Particle counts of fluids. A fluid's object has a capacity of `capacity` particles. The first of them,
// [begin, end), exist. The others have no mass and are in no use. souple/fluid/emission.h says which ones come and
// go.

namespace souple {

struct Object;
struct WorldState;

/// Leaves out particles of fluids inside a collider, or inside the surface of a body or an obstacle. One of the two was
/// added since the last step. Logs how many.
void leave_out_covered(WorldState& world);
/// The next step does not do so again. Also leaves out grains that nothing holds.
void leave_out_covered_now(WorldState& world);

/// Before a step of dt seconds: leaves out what is covered, removes the particles in drains, then adds the layers of
/// emitters up to now.
void update_flow(WorldState& world, double dt);

/// After a step: keeps the pressures, by which emitters are held back, with the particles, so that snapshots have them.
void end_flow(WorldState& world);

/// Sets the particle count of a fluid, at most its capacity; new particles are at the origin.
void set_count(WorldState& world, Object& fluid, std::uint32_t count);

}  // namespace souple
