#pragma once

#include "render/draw_list.h"

#include <vector>

namespace souple {
class World;
}

namespace souple::render {

/// Adds the ropes and rods of joints; with `all`, also the point and the axis of every other joint, `size` long [m].
void draw_joints(const World& world, bool all, float size, std::vector<Line>& lines);

}  // namespace souple::render
