#pragma once

#include "souple/world/handle_index.h"
#include "souple/world/name_registry.h"

#include <cstdint>

namespace souple {

/// Handles and names of a world.
struct Registry {
  HandleIndex objects, colliders, joints, ties;
  NameRegistry names;        ///< of objects and colliders
  NameRegistry joint_names;  ///< a joint may have the name of an object
  std::uint32_t next_id = 1;
};

}  // namespace souple
