#pragma once

#include "souple/fluid/fluid_bodies.h"
#include "souple/world/state.h"

#include <optional>

namespace souple {

/// How fluids of a spacing [m] feel an object; nothing when they do not: ropes and grains.
std::optional<Skin> fluid_skin(const Object& object, float spacing);

}  // namespace souple
