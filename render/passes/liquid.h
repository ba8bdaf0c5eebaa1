#pragma once

#include "render/gl/framebuffer.h"
#include "render/gl/vertex_array.h"
#include "render/passes/liquid_splats.h"
#include "render/passes/pass_clock.h"
#include "render/passes/pass_context.h"
#include "render/passes/shadow.h"
#include "render/renderer.h"

#include <optional>
#include <vector>

namespace souple::render {

/// The image of the opaque objects.
struct LitScene {
  const gl::Texture& normal;
  const gl::Texture& depth;
  const gl::Framebuffer& color;  ///< color and depth of the scene
};

/// The surface of liquids in screen space (van der Laan, Green, Sainz 2009): smooths the depth of the balls
/// and shades it over the lit scene with the liquid's thickness.
class LiquidPass {
 public:
  /// Draws over `scene.color`. `bounds` encloses all splats. Requires the camera's bound uniform block and a
  /// drawn shadow map.
  void draw(const LiquidSplats& splats, const Bounds& bounds, const LitScene& scene,
            const PassContext& context, const RenderOptions& options, const ShadowPass& shadow,
            const gl::VertexArray& nothing, PassClock& clock);

  /// Results of the last `draw`, see LiquidImage.
  std::vector<float> read_depth() const;
  std::vector<float> read_thickness() const;

 private:
  struct Targets {
    gl::Texture surface, other_surface, look, nearest;  // at the picture's size
    gl::Texture optics, glow;                           // at half the picture's size
    gl::Texture behind;                                 // the scene behind liquids
    gl::Framebuffer balls, other_balls, depth, other_depth, thickness, clear_thickness, copy;
    Targets(int width, int height);
    void swap();
  };

  void clear();
  void draw_balls(const LiquidSplats& splats);
  void smooth(const RenderOptions& options, const gl::VertexArray& nothing);
  void step();
  void add_up(const LiquidSplats& splats, const gl::Texture& depth);
  void copy(const gl::Framebuffer& color);
  void shade(const LitScene& scene, const ShadowPass& shadow, const gl::VertexArray& nothing);

  gl::Program curvature_flow_{"screen.vert.glsl", "curvature_flow.frag.glsl"};
  gl::Program narrow_range_{"screen.vert.glsl", "narrow_range.frag.glsl"};
  gl::Program clean_up_{"screen.vert.glsl", "narrow_range.frag.glsl", {"CLEAN_UP"}};
  gl::Program shade_{"ray.vert.glsl", "liquid.frag.glsl"};
  std::optional<Targets> targets_;
};

}  // namespace souple::render
