#pragma once

#include "render/gl/framebuffer.h"
#include "render/gl/vertex_array.h"
#include "render/passes/pass_context.h"

#include <optional>

namespace souple::render {

/// Ambient occlusion in screen space, at half the resolution.
class OcclusionPass {
 public:
  OcclusionPass() = default;

  /// Sets the entries of the uniform block that its shaders and occlusion.glsl read.
  static void aim(Frame& frame, const Bounds& bounds, bool on);
  /// Computes occlusion from the material pass's normals and depth; the camera's uniform block must be bound.
  void draw(const gl::Texture& normals, const gl::Texture& depth, const gl::VertexArray& empty_array);
  /// Binds the result for occlusion.glsl; `otherwise` if there is none yet.
  void bind(const gl::Texture& otherwise) const;

 private:
  // Targets of half the picture's size.
  struct Targets {
    gl::Texture depth, rough, smooth;
    gl::Framebuffer depth_target, rough_target, smooth_target;
    Targets(int width, int height);
  };

  gl::Program half_depth_{"screen.vert.glsl", "half_depth.frag.glsl"};
  gl::Program occlusion_{"screen.vert.glsl", "occlusion.frag.glsl"};
  gl::Program blur_{"ray.vert.glsl", "occlusion_blur.frag.glsl"};
  std::optional<Targets> targets_;
};

}  // namespace souple::render
