#include "app/view/view_target.h"

#include <algorithm>

namespace souple::viewer {

void ViewTarget::resize(int width, int height) {
  width = std::max(width, 1), height = std::max(height, 1);
  if (width == framebuffer_.width() && height == framebuffer_.height()) return;
  color_ = render::gl::Texture(GL_RGBA8, width, height);
  framebuffer_ = render::gl::Framebuffer("the view", {&color_}, nullptr);
}

}  // namespace souple::viewer
