#include "render/passes/window.h"

#include <algorithm>

namespace souple::render {

Window window_around(const Bounds& box, const PassContext& context) {
  const Window all{0, 0, context.width, context.height};
  const auto width = static_cast<float>(context.width), height = static_cast<float>(context.height);
  float left = width, right = 0, bottom = height, top = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec4 point{(corner & 1) != 0 ? box.hi.x : box.lo.x, (corner & 2) != 0 ? box.hi.y : box.lo.y,
                     (corner & 4) != 0 ? box.hi.z : box.lo.z, 1};
    const Vec4 clip = context.projection * (context.view * point);
    if (clip.z < -clip.w) return all;  // behind the near plane
    const float x = (0.5f * clip.x / clip.w + 0.5f) * width, y = (0.5f * clip.y / clip.w + 0.5f) * height;
    left = std::min(left, x), right = std::max(right, x);
    bottom = std::min(bottom, y), top = std::max(top, y);
  }
  constexpr float room = 4;
  const int x = static_cast<int>(std::clamp(left - room, 0.0f, width));
  const int y = static_cast<int>(std::clamp(bottom - room, 0.0f, height));
  return {x, y, static_cast<int>(std::clamp(right + room, 0.0f, width)) - x,
          static_cast<int>(std::clamp(top + room, 0.0f, height)) - y};
}

Window common_part(const Window& a, const Window& b) {
  const int x = std::max(a.x, b.x), y = std::max(a.y, b.y);
  return {x, y, std::min(a.x + a.width, b.x + b.width) - x, std::min(a.y + a.height, b.y + b.height) - y};
}

void keep_within(const Window& window, int scale) {
  const int x = window.x / scale, y = window.y / scale;
  glScissor(x, y, (window.x + window.width + scale - 1) / scale - x,
            (window.y + window.height + scale - 1) / scale - y);
  glEnable(GL_SCISSOR_TEST);
}

}  // namespace souple::render
