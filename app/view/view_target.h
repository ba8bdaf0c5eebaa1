#pragma once

#include "render/image.h"

#include <cstdint>

namespace souple::viewer {

/// Framebuffer in which the scene is drawn before it is copied beside the panel: the remaining part of the
/// window.
class ViewTarget {
 public:
  ViewTarget() = default;
  ~ViewTarget();
  ViewTarget(const ViewTarget&) = delete;
  ViewTarget& operator=(const ViewTarget&) = delete;

  /// Sides are at least 1. Throws Error when the graphics card has not enough memory.
  void resize(int width, int height);
  int width() const { return width_; }
  int height() const { return height_; }
  std::uint32_t framebuffer() const { return framebuffer_; }
  /// Copies into another framebuffer with the lower left corner at (x, y) from the lower left, stretched to
  /// this size.
  void copy_to(std::uint32_t framebuffer, int x, int y, int width, int height) const;

 private:
  void release();

  std::uint32_t framebuffer_ = 0, color_ = 0, depth_ = 0;
  int width_ = 0, height_ = 0;
};

/// The content of a framebuffer of this size.
render::Image read_framebuffer(std::uint32_t framebuffer, int width, int height);

}  // namespace souple::viewer
