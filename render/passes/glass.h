#pragma once

#include "render/gl/framebuffer.h"
#include "render/gl/handle.h"
#include "render/gl/vertex_array.h"
#include "render/passes/liquid.h"
#include "render/passes/pass_context.h"
#include "render/passes/surfaces.h"
#include "render/passes/window.h"

#include <array>
#include <optional>

namespace souple::render {

inline void delete_query(GLuint id) {
  glDeleteQueries(1, &id);
}

/// Which glass is drawn.
enum class GlassPart {
  all,             ///< there are no liquids
  behind_liquids,  ///< before the liquids, which refract it
  before_liquids   ///< after the liquids, all others
};

/// Glass, layer by layer from the farthest to the nearest (depth peeling, Everitt 2001). Each layer is where rays enter
/// a solid and where they leave it. It refracts a copy of the picture behind it.
class GlassPass {
 public:
  GlassPass();

  /// Draws over `scene.color`. `bounds` is the bounding box of all glass. Unless part is `all`, LiquidPass::bind_surface
  /// has been called, and `liquids` is the window around liquids. `coarse`: layers have half the picture's edges.
  void draw(GlassPart part, const LitScene& scene, const Bounds& bounds, const Window& liquids,
            SurfacesPass& surfaces, PassContext context, bool coarse, const gl::VertexArray& empty_array);

 private:
  struct Targets {
    int scale;                         // pixels of the picture per pixel of a layer along an edge
    std::array<gl::Texture, 2> entry;  // of this layer and of the one behind it
    gl::Texture look, exit, depth, behind;
    std::array<gl::Framebuffer, 2> entry_target;
    gl::Framebuffer exit_target, copy;
    Targets(int width, int height, int layer_scale);
  };
  bool find_layer(int layer, SurfacesPass& surfaces, PassContext& context);

  SkyProgram shade_{"glass.frag.glsl"};
  std::optional<Targets> targets_;
  gl::Handle<delete_query> query_;  // whether a layer has pixels
};

}  // namespace souple::render
