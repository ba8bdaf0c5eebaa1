#pragma once

#include "souple/world/state.h"

namespace souple {

/// An edit that an exception may leave half done. Unless `done` is called, functions that need the whole world then
/// refuse: require_whole throws.
class Edit {
 public:
  explicit Edit(WorldState& world);
  void done();

 private:
  WorldState& world_;
};

/// After an exception in a step that began at `start` [s]: the particles return to their positions before the step, if
/// it had saved them. The world refuses all functions that need it whole until World::restore. Allocates nothing.
void abandon_step(WorldState& world, double start) noexcept;

/// For World::restore: everything that is computed from objects and settings is rebuilt before the next step.
void start_afresh(WorldState& world);

}  // namespace souple
