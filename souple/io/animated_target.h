#pragma once

#include "souple/io/animated_points.h"
#include "souple/world/world.h"

#include <memory>

namespace souple {

/// Where a pinned or attached vertex has to be, from an animation with a point for each vertex of the object,
/// in user order: `world.pin(cloth, group("hem"), animated_target(points))`. The positions are evaluated once
/// for each moment asked. Throws Error when called for a vertex that the animation does not have.
Target animated_target(std::shared_ptr<AnimatedPoints> points);

}  // namespace souple
