#pragma once

#include "souple/solver/projector.h"
#include "souple/world/proximity.h"

#include <cstdint>
#include <vector>

// Objects at rest fall asleep in islands of objects in contact. The inverse masses of a sleeping object are
// 0, so other objects collide with it as with a pinned one. `island` of its Object marks it as asleep.

namespace souple {

struct Object;

/// Sleep state that affects a step, and temporary data.
struct SleepScratch {
  bool woken = false;  ///< an object woke during a step: near pairs must be found again
  bool all = false;    ///< all movable objects are asleep, so there is nothing to solve
  ProximityQuery proximity;
  std::vector<std::uint32_t> parent;  ///< per object: parent in its island (union-find)
  /// Per object: 1 if it must not sleep; for an island: of its first object.
  std::vector<std::uint8_t> cannot_sleep;
  /// Per chunk of an object's particles: max squared displacement in the step [m^2].
  std::vector<float> chunk_displacement_squared;
};

/// Before a step: wakes the islands that moving objects may touch in it.
void wake_disturbed(WorldState& world, double dt);
/// After a step: puts islands to sleep whose objects have been at rest for long enough.
void fall_asleep(WorldState& world, double dt);

/// Wakes the island of an object; rest times restart at 0.
void wake_island(WorldState& world, const Object& object);
void wake_all(WorldState& world);
/// Wakes the objects of a projector's particles; all objects if it does not list its particles.
void wake_particles_of(WorldState& world, const Projector& projector);

/// Inverse mass that a particle of the object has when awake [1/kg]; 0: pinned.
float inverse_mass_awake(const WorldState& world, const Object& object, std::uint32_t particle);
/// Sets the inverse masses of all objects according to their sleep state.
void update_sleeping_masses(WorldState& world);

}  // namespace souple
