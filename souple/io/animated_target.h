#pragma once

#include "souple/io/animated_points.h"
#include "souple/world/world.h"

#include <memory>

namespace souple {

/// Target of a pinned or attached vertex, from an animation with a point for each vertex of the object in
/// user order: `world.pin(cloth, group("hem"), animated_target(points))`. The positions are evaluated once
/// per requested time. The target throws Error for a vertex without a point in the animation.
Target animated_target(std::shared_ptr<AnimatedPoints> points);

}  // namespace souple
