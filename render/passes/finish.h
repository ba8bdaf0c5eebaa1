#pragma once

#include "render/gl/framebuffer.h"
#include "render/gl/vertex_array.h"
#include "render/passes/pass_context.h"

#include <cstdint>
#include <optional>

namespace souple::render {

/// Combines the colors of one or more samples and writes them to the caller's framebuffer.
class FinishPass {
 public:
  /// Sums by blending where the context can; otherwise alternately into two buffers.
  FinishPass();

  /// Adds a sample's colors to the sum.
  void add(const gl::Texture& color, bool first, const gl::VertexArray& empty_array);
  /// Writes the encoded mean of `samples` samples; for one sample, `color` itself with smoothed edges.
  void draw(const gl::Texture& color, int samples, std::uint32_t framebuffer,
            const gl::VertexArray& empty_array);

 private:
  struct Sum {
    gl::Texture now, next;  // `next` is empty when blending is used
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
