#pragma once

#include "render/gl/buffer.h"
#include "render/gl/framebuffer.h"
#include "render/passes/liquid_splats.h"
#include "render/passes/pass_context.h"
#include "render/passes/spheres.h"
#include "render/passes/surfaces.h"

namespace souple::render {

/// What the sun sees: a depth map around all that casts shadows.
class ShadowPass {
 public:
  ShadowPass();

  /// Points `frame`'s sun and shadow entries at `casters` (empty: there are no shadows). `offset` in the unit
  /// disk moves the sun within its apparent size.
  void aim(Frame& frame, const Light& light, const Bounds& casters, float offset_x, float offset_y);
  /// Draws the map; `frame` is the one that was aimed. Leaves the sun's uniform block bound.
  void draw(const Frame& frame, SurfacesPass& surfaces, SpheresPass& spheres);
  /// Adds up what liquids take from the sun; right after `draw`.
  void draw_liquids(const LiquidSplats& liquids);
  /// Binds the map for sunlight.glsl, and that of liquids for sun_through_liquid.glsl.
  void bind() const;

 private:
  gl::Texture map_, light_;
  gl::Framebuffer framebuffer_, light_target_;
  gl::Buffer frame_buffer_;
  Mat4 view_, projection_;  // of the sun
};

}  // namespace souple::render
