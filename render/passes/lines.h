#pragma once

#include "render/gl/vertex_array.h"
#include "render/passes/pass_context.h"

#include <span>

namespace souple::render {

/// Lines of constant width, as quads with smooth edges, blended over linear color. The renderer has switched
/// the depth test on or off; lines do not write depth.
class LinesPass {
 public:
  LinesPass();

  void draw(std::span<const Line> lines, const PassContext& context);

 private:
  gl::Program program_{"line.vert.glsl", "line.frag.glsl"};
  gl::Buffer buffer_;
  gl::VertexArray array_;
};

}  // namespace souple::render
