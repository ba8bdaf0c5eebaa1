#include "render/passes/lines.h"

#include <cstddef>

namespace souple::render {

LinesPass::LinesPass() {
  const GLsizei stride = sizeof(Line);
  array_.attribute(buffer_, {0, 3, GL_FLOAT, false, stride, offsetof(Line, a), 1});
  array_.attribute(buffer_, {1, 3, GL_FLOAT, false, stride, offsetof(Line, b), 1});
  array_.attribute(buffer_, {2, 4, GL_UNSIGNED_BYTE, false, stride, offsetof(Line, color), 1});
  array_.attribute(buffer_, {3, 1, GL_FLOAT, false, stride, offsetof(Line, width), 1});
}

void LinesPass::draw(std::span<const Line> lines, const PassContext& context) {
  if (lines.empty()) return;
  buffer_.upload(lines);
  program_.use();
  program_.set("pixels", float(context.width), float(context.height));
  glEnable(GL_BLEND);
  glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  array_.bind();
  glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, GLsizei(lines.size()));
  glBindVertexArray(0);
  glDisable(GL_BLEND);
}

}  // namespace souple::render
