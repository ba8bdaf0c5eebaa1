#pragma once

#include "render/gl/framebuffer.h"
#include "render/gl/vertex_array.h"
#include "render/passes/liquid_splats.h"
#include "render/passes/pass_context.h"
#include "render/passes/shadow.h"
#include "render/passes/sky_program.h"
#include "render/passes/window.h"
#include "render/renderer.h"

#include <optional>
#include <vector>

namespace souple::render {

/// Image of the opaque objects.
struct LitScene {
  const gl::Texture& normal;
  const gl::Texture& depth;
  const gl::Framebuffer& color;  ///< without that depth, which passes read
  bool has_panorama;             ///< the sky is a panorama, which is bound
};

/// Screen-space surface of liquids (van der Laan, Green, Sainz 2009). The depth of the balls is smoothed, then shaded
/// over the lit scene according to the liquid's thickness.
class LiquidPass {
 public:
  /// Depth and thickness of the liquids. `bounds` is the bounding box of all splats. Requires the camera's uniform
  /// block to be bound.
  void find_surface(const LiquidSplats& splats, const Bounds& bounds, const LitScene& scene,
                    const PassContext& context, const RenderOptions& options,
                    const gl::VertexArray& empty_array);
  /// Draws the surface of the last `find_surface` over `scene.color`. Requires the shadow map to be drawn.
  void draw(const LiquidSplats& splats, const LitScene& scene, const ShadowPass& shadow,
            const gl::VertexArray& empty_array);

  /// Only the depth, in a square of `side` pixels for an eye whose uniform block is bound, `smoother` times as smooth.
  void find_depth(const LiquidSplats& splats, int side, const RenderOptions& options, float smoother,
                  const gl::VertexArray& empty_array);

  /// Binds the surface of the last `find_surface` or `find_depth`.
  void bind_surface() const { targets_->surface.bind(gl::Unit::liquid_depth); }
  void bind_look() const { targets_->look.bind(gl::Unit::liquid_look); }
  /// The window around the liquids of the last `find_surface`.
  const Window& window() const { return window_; }
  /// Results of the last `find_surface`, as in LiquidImage.
  std::vector<float> read_depth() const;
  std::vector<float> read_thickness() const;

 private:
  struct Targets {
    gl::Texture surface, other_surface, look, nearest;  // of the picture's size
    int scale;                                          // pixels of the picture per texel of the thickness
    gl::Texture optics, glow;                           // of the picture's size over `scale`
    gl::Texture behind;                                 // the image behind liquids
    gl::Framebuffer balls, other_balls, depth, other_depth, thickness, clear_thickness, copy;
    Targets(int width, int height, int thickness_scale);
    void swap();
  };

  void clear();
  void draw_balls(const LiquidSplats& splats);
  void smooth(const RenderOptions& options, float smoother, const gl::VertexArray& empty_array);
  void resize(int width, int height, int thickness_scale);
  void step();
  void sum_thickness(const LiquidSplats& splats, const gl::Texture& depth);
  void shade(const LiquidSplats& splats, const LitScene& scene, const ShadowPass& shadow,
             const gl::VertexArray& empty_array);

  gl::Program curvature_flow_{"screen.vert.glsl", "curvature_flow.frag.glsl"};
  gl::Program narrow_range_{"screen.vert.glsl", "narrow_range.frag.glsl"};
  gl::Program clean_up_{"screen.vert.glsl", "narrow_range.frag.glsl", {"CLEAN_UP"}};
  SkyProgram shade_{"liquid.frag.glsl"};
  std::optional<Targets> targets_;
  Window window_;  // around the liquids
};

}  // namespace souple::render
