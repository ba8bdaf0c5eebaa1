#pragma once

#include "souple/solver/projector.h"
#include "souple/world/proximity.h"

#include <cstdint>
#include <vector>

// Objects at rest fall asleep, in islands of what is in touch. A sleeper's inverse masses are 0, so
// everything else meets it as it meets a pinned thing; that it sleeps is `island` of its Object.

namespace souple {

struct Object;

/// What of a step depends on who sleeps, and scratch.
struct SleepScratch {
  bool woken = false;  ///< someone woke in the middle of a step: near pairs are to be found again
  bool all = false;    ///< there are only sleepers and obstacles, so nothing to solve
  ProximityQuery proximity;
  std::vector<std::uint32_t> parent;       ///< of each object in its island, while islands are found
  std::vector<std::uint8_t> cannot_sleep;  ///< objects that must not sleep; of an island by its first object
  std::vector<float> chunk_displacement_squared;  ///< of each chunk of an object's particles [m]
};

/// Before a step: wakes the islands that something may touch in it which moves.
void wake_disturbed(WorldState& world, double dt);
/// After a step: islands of which nothing has moved for long enough fall asleep.
void fall_asleep(WorldState& world, double dt);

/// Wakes the island of an object; its rest begins anew.
void wake_island(WorldState& world, const Object& object);
void wake_all(WorldState& world);
/// Wakes what a projector holds; all when it does not say what that is.
void wake_particles_of(WorldState& world, const Projector& projector);

/// 1/kg of a particle of the object when it is awake; 0: it is pinned.
float inverse_mass_awake(const WorldState& world, const Object& object, std::uint32_t particle);
/// Sets inverse masses by who sleeps.
void update_sleeping_masses(WorldState& world);

}  // namespace souple
