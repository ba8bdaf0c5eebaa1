#pragma once

#include <atomic>
#include <mutex>

namespace souple {

struct Object;
struct WorldState;

/// Objects that were removed, but whose particles and constraints are still there. They go when somebody looks at the world
/// again, all at once: removing many costs as much as removing one.
struct Removals {
  std::atomic<bool> pending = false;
  std::mutex mutex;  ///< const functions may find them pending on several threads
};

void remove_later(WorldState& world, Object& object);
/// Removes what is pending: particles, and every constraint, joint and tie on one of them. Wakes all objects.
void finish_removals(WorldState& world);

}  // namespace souple
