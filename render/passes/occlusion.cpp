#include "render/passes/occlusion.h"

#include <algorithm>
#include <array>

namespace souple::render {

OcclusionPass::Targets::Targets(int width, int height)
    : depth(GL_R32F, width, height),
      rough(GL_RG16F, width, height),
      smooth(GL_RG16F, width, height),
      depth_target("half the depth", {&depth}, nullptr),
      rough_target("occlusion", {&rough}, nullptr),
      smooth_target("smooth occlusion", {&smooth}, nullptr) {}

void OcclusionPass::aim(Frame& frame, const Bounds& bounds, bool on) {
  frame.sample_info.w = on && !bounds.empty() ? 1.0f : 0.0f;
  // A fraction of the scene: small enough to show contacts, large enough to be visible.
  frame.occlusion = {std::max(0.2f * bounds.radius(), 1e-6f), 1.5f, 0, 0};
}

void OcclusionPass::draw(const gl::Texture& normals, const gl::Texture& depth,
                         const gl::VertexArray& empty_array) {
  const int width = (depth.width() + 1) / 2, height = (depth.height() + 1) / 2;
  if (!targets_ || targets_->depth.width() != width || targets_->depth.height() != height) {
    targets_.reset();
    targets_.emplace(width, height);
  }
  glDisable(GL_DEPTH_TEST);
  empty_array.bind();
  targets_->depth_target.bind();
  depth.bind(gl::Unit::depth);
  half_depth_.use();
  draw_screen();

  targets_->rough_target.bind();
  const std::array<float, 4> open{1, 0, 0, 0};
  glClearBufferfv(GL_COLOR, 0, open.data());
  targets_->depth.bind(gl::Unit::depth);
  normals.bind(gl::Unit::normal);
  occlusion_.use();
  draw_screen();

  targets_->smooth_target.bind();
  targets_->rough.bind(gl::Unit::occlusion);
  blur_.use();
  draw_screen();
}

void OcclusionPass::bind(const gl::Texture& otherwise) const {
  (targets_ ? targets_->smooth : otherwise).bind(gl::Unit::occlusion);
}

}  // namespace souple::render
