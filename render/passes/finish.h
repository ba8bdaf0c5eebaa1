#pragma once

#include "render/gl/framebuffer.h"
#include "render/gl/vertex_array.h"
#include "render/passes/pass_context.h"

#include <cstdint>
#include <optional>

namespace souple::render {

/// Combines the colors of one or many samples in the caller's framebuffer.
class FinishPass {
 public:
  /// Detects whether the context can sum by blending; otherwise the sum alternates between two buffers.
  FinishPass();

  /// Adds the colors of a sample.
  void add(const gl::Texture& color, bool first, const gl::VertexArray& nothing);
  /// Writes the encoded mean of `samples` samples; for one sample, `color` with smoothed edges.
  void draw(const gl::Texture& color, int samples, std::uint32_t framebuffer, const gl::VertexArray& nothing);

 private:
  struct Sum {
    gl::Texture now, next;  // `next` is empty if sums are made by blending
    gl::Framebuffer now_target, next_target;
    Sum(int width, int height, bool two);
  };
  struct Encoded {
    gl::Texture color;
    gl::Framebuffer target;
    Encoded(int width, int height);
  };

  gl::Program add_{"screen.vert.glsl", "add.frag.glsl"};
  gl::Program add_to_{"screen.vert.glsl", "add.frag.glsl", {"ADD_TO_SUM"}};
  gl::Program resolve_{"screen.vert.glsl", "resolve.frag.glsl"};
  gl::Program smooth_edges_{"screen.vert.glsl", "smooth_edges.frag.glsl"};
  bool blends_;
  std::optional<Sum> sum_;
  std::optional<Encoded> encoded_;
};

}  // namespace souple::render
