#include "render/passes/finish.h"

#include <utility>

namespace souple::render {

namespace {

bool is_size_of(const gl::Texture& texture, const gl::Texture& other) {
  return texture.width() == other.width() && texture.height() == other.height();
}

}  // namespace

FinishPass::Sum::Sum(int width, int height, bool two)
    : now(GL_RGBA32F, width, height), now_target("the sum of samples", {&now}, nullptr) {
  if (!two) return;
  next = gl::Texture(GL_RGBA32F, width, height);
  next_target = gl::Framebuffer("the sum of samples", {&next}, nullptr);
}

FinishPass::Encoded::Encoded(int width, int height)
    : color(GL_RGBA8, width, height, GL_LINEAR), target("a picture", {&color}, nullptr) {}

FinishPass::FinishPass() : blends_(gl::can_blend_floats()) {}

void FinishPass::add(const gl::Texture& color, bool first, const gl::VertexArray& empty_array) {
  if (!sum_ || !is_size_of(sum_->now, color)) {
    sum_.reset();
    sum_.emplace(color.width(), color.height(), !blends_);
  }
  empty_array.bind();
  color.bind(gl::Unit::color);
  if (first || blends_) {
    sum_->now_target.bind();
    if (!first) glEnable(GL_BLEND);
    glBlendFunc(GL_ONE, GL_ONE);
    add_.use();
  } else {
    sum_->next_target.bind();
    sum_->now.bind(gl::Unit::sum);
    add_to_.use();
  }
  draw_screen();
  glDisable(GL_BLEND);
  if (first || blends_) return;
  std::swap(sum_->now, sum_->next);
  std::swap(sum_->now_target, sum_->next_target);
}

void FinishPass::draw(const gl::Texture& color, int samples, std::uint32_t framebuffer,
                      const gl::VertexArray& empty_array) {
  const bool one = samples <= 1;
  if (one && (!encoded_ || !is_size_of(encoded_->color, color))) {
    encoded_.reset();
    encoded_.emplace(color.width(), color.height());
  }
  empty_array.bind();
  glBindFramebuffer(GL_FRAMEBUFFER, one ? encoded_->target.id() : framebuffer);
  glViewport(0, 0, color.width(), color.height());
  (one ? color : sum_->now).bind(gl::Unit::color);
  resolve_.use();
  resolve_.set("scale", 1.0f / float(one ? 1 : samples));
  resolve_.set("alpha_is_luma", one ? 1.0f : 0.0f);
  draw_screen();
  if (!one) return;
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
  encoded_->color.bind(gl::Unit::color);
  smooth_edges_.use();
  draw_screen();
}

}  // namespace souple::render
