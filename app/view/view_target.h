#pragma once

#include "render/gl/framebuffer.h"

namespace souple::viewer {

/// Framebuffer in which the scene is drawn before it is copied beside the panel: the remaining part of the
/// window.
class ViewTarget {
 public:
  /// Sides are at least 1. Throws Error when the graphics card has not enough memory.
  void resize(int width, int height);
  const render::gl::Framebuffer& framebuffer() const { return framebuffer_; }

 private:
  render::gl::Texture color_;
  render::gl::Framebuffer framebuffer_;
};

}  // namespace souple::viewer
