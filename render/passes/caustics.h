#pragma once

#include "render/gl/framebuffer.h"
#include "render/gl/vertex_array.h"
#include "render/passes/liquid.h"
#include "render/passes/pass_context.h"

namespace souple::render {

/// Sunlight that liquids refract onto a level floor (Wyman and Davis 2006, "Interactive image-space techniques for
/// approximating caustics"). Rays on a grid meet the smoothed surface of the liquids as the sun sees it. They are
/// refracted there, and add up where they meet the floor. A ray that meets no liquid goes straight on.
class CausticsPass {
 public:
  CausticsPass();

  /// Draws the map of the floor at `height` below the liquids in `bounds`. The sun is that of `frame`.
  void draw(const Frame& frame, const LiquidSplats& splats, const Bounds& bounds, float height,
            const gl::VertexArray& empty_array);
  /// Binds the map for a program in use that has the shader caustics.glsl.
  void bind(const gl::Program& program) const;

 private:
  gl::Program rays_{"caustics.vert.glsl", "caustics.frag.glsl"};
  gl::Texture light_;  // number of rays
  gl::Framebuffer target_;
  gl::Buffer frame_buffer_;
  LiquidPass surface_;
  Mat4 to_map_;  // world -> (x, y, depth), each in [0, 1]
  Vec4 floor_;   // height and tolerance [m]
};

}  // namespace souple::render
