#pragma once

#include "render/gl/texture.h"

#include <string_view>
#include <vector>

namespace souple::render::gl {

inline void delete_framebuffer(GLuint id) {
  glDeleteFramebuffers(1, &id);
}

/// Whether what is drawn can be blended into textures of 32 bit floats; into those of 16 it always can.
bool can_blend_floats();

/// Textures to draw into; they have to outlive it.
class Framebuffer {
 public:
  Framebuffer() = default;
  /// Color attachments 0, 1, ...; `depth` may be null. Throws Error, naming `what`, when the context cannot
  /// draw into these formats.
  Framebuffer(std::string_view what, const std::vector<const Texture*>& colors, const Texture* depth);

  /// For drawing, with a viewport of its whole size.
  void bind() const;
  GLuint id() const { return handle_.id(); }
  int width() const { return width_; }
  int height() const { return height_; }

 private:
  Handle<delete_framebuffer> handle_;
  int width_ = 0, height_ = 0;
};

}  // namespace souple::render::gl
