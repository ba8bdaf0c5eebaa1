#include "render/gl/framebuffer.h"

#include "souple/error.h"

#include <fmt/core.h>

namespace souple::render::gl {

bool can_blend_floats() {
  // Always in desktop OpenGL since 3.0.
  return !is_es() || has_extension("GL_EXT_float_blend");
}

Framebuffer::Framebuffer(std::string_view what, const std::vector<const Texture*>& colors,
                         const Texture* depth) {
  GLuint id = 0;
  glGenFramebuffers(1, &id);
  handle_ = Handle<delete_framebuffer>(id);
  glBindFramebuffer(GL_FRAMEBUFFER, id);
  std::vector<GLenum> attachments;
  for (const Texture* color : colors) {
    const GLenum attachment = GL_COLOR_ATTACHMENT0 + GLenum(attachments.size());
    glFramebufferTexture2D(GL_FRAMEBUFFER, attachment, GL_TEXTURE_2D, color->id(), 0);
    attachments.push_back(attachment);
  }
  if (depth != nullptr) {
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, depth->id(), 0);
  }
  if (attachments.empty()) attachments.push_back(GL_NONE);
  glDrawBuffers(GLsizei(attachments.size()), attachments.data());
  if (colors.empty()) glReadBuffer(GL_NONE);
  const Texture& first = colors.empty() ? *depth : *colors.front();
  width_ = first.width();
  height_ = first.height();
  const GLenum status = glCheckFramebufferStatus(GL_FRAMEBUFFER);
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  if (status != GL_FRAMEBUFFER_COMPLETE) {
    throw Error(
        fmt::format("OpenGL cannot draw into the buffer for {} of {} x {} pixels (status {}); try a smaller "
                    "picture, or Mesa's llvmpipe: LIBGL_ALWAYS_SOFTWARE=1",
                    what, width_, height_, status));
  }
}

void Framebuffer::bind() const {
  glBindFramebuffer(GL_FRAMEBUFFER, id());
  glViewport(0, 0, width_, height_);
}

void Framebuffer::copy_to(GLuint other, int x, int y, int width, int height) const {
  glBindFramebuffer(GL_READ_FRAMEBUFFER, id());
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, other);
  const GLenum filter = width == width_ && height == height_ ? GL_NEAREST : GL_LINEAR;
  glBlitFramebuffer(0, 0, width_, height_, x, y, x + width, y + height, GL_COLOR_BUFFER_BIT, filter);
}

}  // namespace souple::render::gl
