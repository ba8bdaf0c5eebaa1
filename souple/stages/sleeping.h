#pragma once

#include "souple/math/disjoint_sets.h"
#include "souple/solver/left_out.h"
#include "souple/stages/proximity.h"
#include "souple/stages/stage_view.h"

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

// Objects at rest fall asleep in islands of objects in contact. The inverse masses of a sleeping object are
// 0, so other objects collide with it as with a pinned one. `island` of its Object marks it as asleep.

namespace souple {

struct ColliderRecord;
struct Object;
struct UserConstraint;

/// Indices of objects that joints of rigid bodies hold.
struct JoinedObjects {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;  ///< they sleep together
  std::vector<std::uint32_t> driven;  ///< by a collider that moves: they do not sleep
};

/// Sleep state that affects a step, and temporary data.
struct SleepScratch {
  bool woken = false;  ///< an object woke during a step: near pairs must be found again
  bool all = false;    ///< all movable objects are asleep, so there is nothing to solve
  bool idle = false;   ///< while `all`: no obstacle moves either, so a substep changes nothing
  bool changed =
      true;  ///< an object woke or fell asleep, or constraints changed: `constraints` is out of date
  LeftOut constraints;  ///< of sleeping objects, which move nothing; see leave_out_asleep
  JoinedObjects joined;
  ProximityQuery proximity;
  DisjointSets islands;  ///< of objects
  /// Per object: 1 if it must not sleep; for an island: of its first object.
  std::vector<std::uint8_t> cannot_sleep;
  /// Per chunk of an object's particles: max squared displacement in the step [m^2].
  std::vector<float> chunk_displacement_squared;

  bool rests() const { return all && idle; }
};

/// State that sleeping and waking read and change.
struct SleepView {
  StageView stage;
  const ContactTables& tables;
  std::span<const ColliderRecord> colliders;  ///< as in `tables`
  std::span<const UserConstraint> constraints;
  SleepScratch& sleep;
};

/// Particles before a step.
struct StartOfStep {
  std::span<const Vec4f> position, offset;
};

/// Before a step: wakes the islands that moving objects may touch in it. Returns the number of objects asleep.
std::size_t wake_disturbed(const SleepView& step, double dt);
/// After a step: puts islands to sleep whose objects have been at rest for long enough. Returns the number of objects
/// asleep. `has_force_fields`: forces of users may act at any time.
std::size_t fall_asleep(const SleepView& step, const StartOfStep& start, bool has_force_fields, double dt);

/// Updates `constraints`: only projectors count in which each constraint belongs to one object.
void leave_out_asleep(const ObjectsView& objects, std::span<Projector* const> projectors,
                      SleepScratch& sleep);

/// Wakes the island of an object; rest times restart at 0.
void wake_island(const ObjectsView& objects, const Object& object, SleepScratch& sleep);
void wake_all(const ObjectsView& objects, SleepScratch& sleep);
/// Wakes the objects of a projector's particles; all objects if it does not list its particles.
void wake_particles_of(const ObjectsView& objects, const Projector& projector, SleepScratch& sleep);

/// Inverse mass that a particle of the object has when awake [1/kg]; 0: pinned.
float inverse_mass_awake(const Particles& particles, const Object& object, std::uint32_t particle);
/// Sets the inverse masses of all objects according to their sleep state.
void update_sleeping_masses(const ObjectsView& objects, SleepScratch& sleep);

}  // namespace souple
