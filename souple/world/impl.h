#pragma once

#include "souple/world/state.h"
#include "souple/world/world.h"

namespace souple {

struct World::Impl {
  WorldState state;
};

}  // namespace souple
