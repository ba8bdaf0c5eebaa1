#pragma once

#include "render/gl/texture.h"

#include <string_view>
#include <vector>

namespace souple::render::gl {

inline void delete_framebuffer(GLuint id) {
  glDeleteFramebuffers(1, &id);
}

/// Whether blending works in textures of 32 bit floats; in 16 bit floats it always does.
bool can_blend_floats();

/// Textures to draw into; they must outlive the framebuffer.
class Framebuffer {
 public:
  Framebuffer() = default;
  /// Color attachments 0, 1, ...; `depth` may be null. Throws Error with the name `what` when the context
  /// cannot draw into these formats.
  Framebuffer(std::string_view what, const std::vector<const Texture*>& colors, const Texture* depth);

  /// Binds it for drawing, with a viewport of its whole size.
  void bind() const;
  /// Copies color 0 into another framebuffer, stretched to this rectangle from the lower left.
  void copy_to(GLuint other, int x, int y, int width, int height) const;
  GLuint id() const { return handle_.id(); }
  int width() const { return width_; }
  int height() const { return height_; }

 private:
  Handle<delete_framebuffer> handle_;
  int width_ = 0, height_ = 0;
};

}  // namespace souple::render::gl
