#pragma once

#include "render/image.h"

#include <cstdint>

namespace souple::viewer {

/// Render target of the scene's part of the window; it is then copied beside the panel.
class ViewTarget {
 public:
  ViewTarget() = default;
  ~ViewTarget();
  ViewTarget(const ViewTarget&) = delete;
  ViewTarget& operator=(const ViewTarget&) = delete;

  /// Sets the size, at least 1 x 1. Throws Error if graphics memory is insufficient.
  void resize(int width, int height);
  int width() const { return width_; }
  int height() const { return height_; }
  std::uint32_t framebuffer() const { return framebuffer_; }
  /// Copies the target into another framebuffer: lower left corner at (x, y), scaled to this size.
  void copy_to(std::uint32_t framebuffer, int x, int y, int width, int height) const;

 private:
  void release();

  std::uint32_t framebuffer_ = 0, color_ = 0, depth_ = 0;
  int width_ = 0, height_ = 0;
};

/// Reads a framebuffer of this size.
render::Image read_framebuffer(std::uint32_t framebuffer, int width, int height);

}  // namespace souple::viewer
