#pragma once

#include "souple/objects/callbacks.h"
#include "souple/stages/callback_list.h"
#include "souple/world/report.h"

#include <array>
#include <cstdint>
#include <functional>

namespace souple {

class World;

/// Functions of the user.
struct Callbacks {
  CallbackList<VertexForceField> force_fields;
  std::array<CallbackList<std::function<void(World&)>>, stage_count> before, after;
  std::uint32_t next_id = 1;

  void erase_removed();
};

}  // namespace souple
