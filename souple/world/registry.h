#pragma once

#include "souple/world/handle_index.h"
#include "souple/world/name_registry.h"

#include <cstdint>
#include <string_view>

namespace souple {

/// Handles and names of a world.
struct Registry {
  HandleIndex objects, colliders, joints, ties;
  NameRegistry names;        ///< of objects and colliders
  NameRegistry joint_names;  ///< a joint may have the name of an object
  std::uint32_t next_id = 1;
};

/// Throws Error: there is no `what`, such as a joint, with the handle.
[[noreturn]] void throw_stale(std::string_view what, std::uint32_t handle);

}  // namespace souple
