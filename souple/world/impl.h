#pragma once

#include "souple/world/state.h"

namespace souple {

struct World::Impl {
  WorldState state;
};

}  // namespace souple
