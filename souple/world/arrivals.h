#pragma once

#include "souple/math/transform.h"

namespace souple {

struct ColliderRecord;
struct WorldState;

/// Moves a collider to a pose during the next step: World::move_collider.
struct Arrival {
  Transform from{}, to{};
  double start = 0, length = 0;  ///< of the current step [s]; length 0: between steps, the pose is `from`

  Transform at(double time) const;
};

/// Between these two calls colliders and pins move to the poses that the user set. A failed step (`made`
/// false) leaves them where they were.
void begin_arrivals(WorldState& world, double dt);
void end_arrivals(WorldState& world, bool made);

/// Puts a collider at a pose without motion, from which it moves on: for restored worlds.
void place_collider(WorldState& world, ColliderRecord& record, const Transform& pose);

}  // namespace souple
