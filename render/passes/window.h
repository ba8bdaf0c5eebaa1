#pragma once

#include "render/camera.h"
#include "render/passes/pass_context.h"

namespace souple::render {

/// A part of the picture: pixels, from the bottom left.
struct Window {
  int x = 0, y = 0, width = 0, height = 0;
};

/// The smallest upright window around a box, with some margin.
Window window_around(const Bounds& box, const PassContext& context);

/// The part that both cover; width or height is 0 or less where there is none.
Window common_part(const Window& a, const Window& b);

/// Restricts drawing to this part of the window at this scale.
void keep_within(const Window& window, int scale);

}  // namespace souple::render
