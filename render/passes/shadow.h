#pragma once

#include "render/gl/buffer.h"
#include "render/gl/framebuffer.h"
#include "render/passes/liquid_splats.h"
#include "render/passes/pass_context.h"
#include "render/passes/spheres.h"
#include "render/passes/surfaces.h"

namespace souple::render {

/// The shadow map: depth from the sun around all objects that cast shadows.
class ShadowPass {
 public:
  ShadowPass();

  /// Sets the sun and shadow entries of `frame` for `casters` (empty: no shadows). `offset` in the unit disk
  /// moves the sun within its apparent size.
  void aim(Frame& frame, const Light& light, const Bounds& casters, float offset_x, float offset_y);
  /// Draws the map; `frame` is the frame passed to `aim`. Leaves the sun's uniform block bound.
  void draw(const Frame& frame, SurfacesPass& surfaces, SpheresPass& spheres);
  /// Sums the sunlight that liquids and glass absorb; call directly after `draw`.
  void draw_light(const LiquidSplats& liquids, SurfacesPass& surfaces, bool coarse);
  /// Binds the map for sunlight.glsl, and that of liquids and glass for sun_through_liquid.glsl.
  void bind() const;

 private:
  void resize_light(int side);

  gl::Texture map_, light_;
  gl::Framebuffer framebuffer_, light_target_;
  gl::Buffer frame_buffer_;
  Mat4 view_, projection_;  // of the sun
};

}  // namespace souple::render
