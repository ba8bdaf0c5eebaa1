#pragma once

#include "render/gl/buffer.h"
#include "render/gl/framebuffer.h"
#include "render/passes/liquid_splats.h"
#include "render/passes/pass_context.h"
#include "render/passes/spheres.h"
#include "render/passes/surfaces.h"

namespace souple::render {

/// Shadow map: depth seen from the sun, around all shadow casters.
class ShadowPass {
 public:
  ShadowPass();

  /// Sets `frame`'s sun and shadow entries to enclose `casters` (empty: no shadows). `offset` in the unit
  /// disk moves the sun within its apparent size.
  void aim(Frame& frame, const Light& light, const Bounds& casters, float offset_x, float offset_y);
  /// Draws the map for the `frame` passed to `aim`. Leaves the sun's uniform block bound.
  void draw(const Frame& frame, SurfacesPass& surfaces, SpheresPass& spheres);
  /// Adds the light that liquids absorb; call directly after `draw`.
  void draw_liquids(const LiquidSplats& liquids);
  /// Binds the map for sunlight.glsl and the map of liquids for sun_through_liquid.glsl.
  void bind() const;

 private:
  gl::Texture map_, light_;
  gl::Framebuffer framebuffer_, light_target_;
  gl::Buffer frame_buffer_;
  Mat4 view_, projection_;  // of the sun
};

}  // namespace souple::render
