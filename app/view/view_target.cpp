#include "app/view/view_target.h"

#include "souple/error.h"

#include <algorithm>
#include <cstddef>
#include <epoxy/gl.h>

#include <fmt/core.h>

namespace souple::viewer {

ViewTarget::~ViewTarget() {
  release();
}

void ViewTarget::release() {
  if (framebuffer_ == 0) return;
  glDeleteFramebuffers(1, &framebuffer_);
  glDeleteTextures(1, &color_);
  glDeleteRenderbuffers(1, &depth_);
  framebuffer_ = 0;
}

void ViewTarget::resize(int width, int height) {
  width = std::max(width, 1), height = std::max(height, 1);
  if (framebuffer_ != 0 && width == width_ && height == height_) return;
  release();
  width_ = width, height_ = height;
  glGenFramebuffers(1, &framebuffer_);
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
  glGenTextures(1, &color_);
  glBindTexture(GL_TEXTURE_2D, color_);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, width, height, 0, GL_RGBA, GL_UNSIGNED_BYTE, nullptr);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, color_, 0);
  glGenRenderbuffers(1, &depth_);
  glBindRenderbuffer(GL_RENDERBUFFER, depth_);
  glRenderbufferStorage(GL_RENDERBUFFER, GL_DEPTH_COMPONENT24, width, height);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, depth_);
  if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
    throw Error(
        fmt::format("the graphics card cannot allocate a picture of {} x {} pixels; try a smaller window",
                    width, height));
  }
}

void ViewTarget::copy_to(std::uint32_t framebuffer, int x, int y, int width, int height) const {
  glBindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer_);
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, framebuffer);
  glDisable(GL_SCISSOR_TEST);
  const GLenum filter = width == width_ && height == height_ ? GL_NEAREST : GL_LINEAR;
  glBlitFramebuffer(0, 0, width_, height_, x, y, x + width, y + height, GL_COLOR_BUFFER_BIT, filter);
}

render::Image read_framebuffer(std::uint32_t framebuffer, int width, int height) {
  render::Image image(width, height);
  glBindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, image.pixels.data());
  const std::size_t row = 4 * static_cast<std::size_t>(width);
  for (int y = 0; y < height / 2; ++y)  // OpenGL's rows begin at the bottom
    std::swap_ranges(image.at(0, y), image.at(0, y) + row, image.at(0, height - 1 - y));
  for (std::size_t i = 3; i < image.pixels.size(); i += 4) image.pixels[i] = 255;
  return image;
}

}  // namespace souple::viewer
