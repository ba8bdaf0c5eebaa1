#include "render/passes/lines.h"

#include "render/gl/vertex_array.h"

#include <cstddef>

namespace souple::render {

struct LinesPass::Impl {
  Impl() {
    const GLsizei stride = sizeof(Line);
    array.attribute(buffer, {0, 3, GL_FLOAT, false, stride, offsetof(Line, a), 1});
    array.attribute(buffer, {1, 3, GL_FLOAT, false, stride, offsetof(Line, b), 1});
    array.attribute(buffer, {2, 4, GL_UNSIGNED_BYTE, false, stride, offsetof(Line, color), 1});
    array.attribute(buffer, {3, 1, GL_FLOAT, false, stride, offsetof(Line, width), 1});
  }

  gl::Program program{"line.vert.glsl", "line.frag.glsl"};
  gl::Buffer buffer;
  gl::VertexArray array;
};

LinesPass::LinesPass() : impl_(std::make_unique<Impl>()) {}
LinesPass::~LinesPass() = default;

void LinesPass::draw(std::span<const Line> lines, const PassContext& context) {
  if (lines.empty()) return;
  impl_->buffer.upload(lines);
  impl_->program.use();
  impl_->program.set("pixels", float(context.width), float(context.height));
  glEnable(GL_BLEND);
  glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  impl_->array.bind();
  glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, GLsizei(lines.size()));
  glBindVertexArray(0);
  glDisable(GL_BLEND);
}

}  // namespace souple::render
