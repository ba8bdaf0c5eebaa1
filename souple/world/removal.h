#pragma once

#include "souple/objects/handles.h"

#include <atomic>
#include <cstdint>
#include <mutex>
#include <unordered_set>

namespace souple {

struct WorldState;

/// Objects that were removed, but whose particles and constraints are still there. They go when somebody looks at the world
/// again, all at once: removing many costs as much as removing one.
struct Removals {
  std::atomic<bool> pending = false;
  std::unordered_set<std::uint32_t> objects;
  std::mutex mutex;  ///< const functions may find them pending on several threads
};

/// Whether the world has the object. Does not finish what is pending.
bool contains_object(const WorldState& world, ObjectId id);
void remove_later(WorldState& world, ObjectId id);
/// Removes what is pending: particles, and every constraint, joint and tie on one of them. Wakes all objects.
void finish_removals(WorldState& world);

}  // namespace souple
