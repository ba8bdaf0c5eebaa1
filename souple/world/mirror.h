#pragma once

#include "souple/objects/handles.h"

namespace souple {

struct Mirror;
struct WorldState;

/// The object's mirror with current positions. The caller holds WorldState::cache_lock.
Mirror& fresh_mirror(const WorldState& world, ObjectId id);

}  // namespace souple
