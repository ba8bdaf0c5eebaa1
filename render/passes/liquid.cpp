#include "render/passes/liquid.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace souple::render {

namespace {

/// Amount of smoothing of the depth, as the standard deviation of a Gaussian with equal effect, in radii of
/// the balls.
constexpr float smoothing = 1.25f;

constexpr int fine_scale = 2, coarse_scale = 4;  // pixels of the picture per texel of the thickness

constexpr int default_flow_steps = 40, default_range_passes = 2;

/// For sums over hundreds of particles: 16 bits lose some per cent where hardware rounds down, as llvmpipe
/// does.
GLenum sum_format() {
  const bool filters = !gl::is_es() || gl::has_extension("GL_OES_texture_float_linear");
  return filters && gl::can_blend_floats() ? GL_RGBA32F : GL_RGBA16F;
}

/// One channel of a framebuffer of floats. OpenGL ES reads all four.
std::vector<float> read(const gl::Framebuffer& from, std::size_t channel) {
  const std::size_t count = std::size_t(from.width()) * std::size_t(from.height());
  std::vector<float> texels(4 * count), result(count);
  from.bind();
  glReadBuffer(GL_COLOR_ATTACHMENT0);
  glPixelStorei(GL_PACK_ALIGNMENT, 4);
  glReadPixels(0, 0, from.width(), from.height(), GL_RGBA, GL_FLOAT, texels.data());
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  for (std::size_t i = 0; i < count; ++i) result[i] = texels[4 * i + channel];
  return result;
}

}  // namespace

LiquidPass::Targets::Targets(int width, int height, int thickness_scale)
    : surface(GL_R32F, width, height),
      other_surface(GL_R32F, width, height),
      look(GL_RGBA16F, width, height),
      nearest(GL_DEPTH_COMPONENT32F, width, height),
      scale(thickness_scale),
      optics(sum_format(), (width + scale - 1) / scale, (height + scale - 1) / scale, GL_LINEAR),
      glow(sum_format(), (width + scale - 1) / scale, (height + scale - 1) / scale, GL_LINEAR),
      behind(GL_RGBA16F, width, height, GL_LINEAR),
      balls("the balls of liquids", {&surface, &look}, &nearest),
      other_balls("the balls of liquids", {&other_surface, &look}, &nearest),
      depth("the surface of liquids", {&surface}, nullptr),
      other_depth("the smoothed surface of liquids", {&other_surface}, nullptr),
      thickness("the thickness of liquids", {&optics, &glow}, nullptr),
      clear_thickness("the thickness of clear liquids", {&optics}, nullptr),
      copy("what is behind liquids", {&behind}, nullptr) {}

void LiquidPass::Targets::swap() {
  std::swap(surface, other_surface);
  std::swap(balls, other_balls);
  std::swap(depth, other_depth);
}

/// Clears all targets: passes draw into and read around a part only.
void LiquidPass::clear() {
  targets_->other_depth.bind();
  clear_color(0);
  targets_->thickness.bind();
  clear_color(0);
  clear_color(1);
  targets_->balls.bind();
  clear_color(0);
  clear_color(1);
  clear_depth(1);
}

void LiquidPass::draw_balls(const LiquidSplats& splats) {
  targets_->balls.bind();
  glEnable(GL_DEPTH_TEST);
  glDepthMask(GL_TRUE);
  splats.draw(SplatTarget::depth);
  glDisable(GL_DEPTH_TEST);
}

void LiquidPass::step() {
  targets_->surface.bind(gl::Unit::liquid_depth);
  targets_->other_depth.bind();
  draw_screen();
  targets_->swap();
}

void LiquidPass::smooth(const RenderOptions& options, float smoother, const gl::VertexArray& empty_array) {
  targets_->look.bind(gl::Unit::liquid_look);
  empty_array.bind();
  if (options.liquid_filter == LiquidFilter::curvature_flow) {
    // Each step is a step of diffusion, with variance stability * reach^2 radii^2. The reach decreases from
    // step to step: narrow differences smooth what wide differences leave between them.
    const int steps = options.liquid_steps > 0 ? options.liquid_steps : default_flow_steps;
    const float mean = smoother * smoothing / std::sqrt(0.4f * float(steps));
    curvature_flow_.use();
    for (int i = 0; i < steps; ++i) {
      curvature_flow_.set("reach", mean * (1.6f - 1.4f * float(i) / float(std::max(steps - 1, 1))));
      step();
    }
  }
  if (options.liquid_filter == LiquidFilter::narrow_range) {
    const int passes = options.liquid_steps > 0 ? options.liquid_steps : default_range_passes;
    narrow_range_.use();
    for (int i = 0; i < passes; ++i) {
      for (const float axis : {0.0f, 1.0f}) {
        narrow_range_.set("axis", axis);
        narrow_range_.set("deviation", smoother * smoothing / float(1 + i));
        step();
      }
    }
    clean_up_.use();
    clean_up_.set("deviation", smoother * smoothing / float(passes));
    step();
  }
}

void LiquidPass::sum_thickness(const LiquidSplats& splats, const gl::Texture& depth) {
  // Blending dominates the cost here: targets that would receive nothing are omitted.
  (splats.is_cloudy() ? targets_->thickness : targets_->clear_thickness).bind();
  depth.bind(gl::Unit::depth);
  targets_->surface.bind(gl::Unit::liquid_depth);
  glEnable(GL_BLEND);
  glBlendFunc(GL_ONE, GL_ONE);
  splats.draw(SplatTarget::thickness, targets_->scale);
  splats.draw(SplatTarget::foam);
  glDisable(GL_BLEND);
}

void LiquidPass::shade(const LiquidSplats& splats, const LitScene& scene, const ShadowPass& shadow,
                       const gl::VertexArray& empty_array) {
  scene.color.bind();
  glDepthMask(GL_FALSE);
  targets_->behind.bind(gl::Unit::color);
  targets_->surface.bind(gl::Unit::liquid_depth);
  targets_->look.bind(gl::Unit::liquid_look);
  targets_->optics.bind(gl::Unit::liquid_optics);
  targets_->glow.bind(gl::Unit::liquid_glow);
  scene.normal.bind(gl::Unit::normal);
  scene.depth.bind(gl::Unit::depth);
  shadow.bind();
  const gl::Program& program = shade_.of(scene.has_panorama);
  program.use();
  program.set("extinction", splats.extinction());
  empty_array.bind();
  draw_screen();
  glDepthMask(GL_TRUE);
}

std::vector<float> LiquidPass::read_depth() const {
  const std::vector<float> rows = read(targets_->depth, 0);
  const auto width = std::size_t(targets_->depth.width()), height = rows.size() / width;
  std::vector<float> result;
  result.reserve(rows.size());
  for (std::size_t y = height; y-- > 0;) {
    const auto row = rows.begin() + std::ptrdiff_t(y * width);
    result.insert(result.end(), row, row + std::ptrdiff_t(width));
  }
  return result;
}

std::vector<float> LiquidPass::read_thickness() const {
  const std::vector<float> coarse = read(targets_->thickness, 3);
  const auto coarse_width = std::size_t(targets_->thickness.width());
  const auto width = std::size_t(targets_->depth.width()), height = std::size_t(targets_->depth.height());
  std::vector<float> result;
  result.reserve(width * height);
  const auto scale = std::size_t(targets_->scale);
  for (std::size_t y = height; y-- > 0;)
    for (std::size_t x = 0; x < width; ++x) result.push_back(coarse[y / scale * coarse_width + x / scale]);
  return result;
}

void LiquidPass::resize(int width, int height, int thickness_scale) {
  if (targets_ && targets_->look.width() == width && targets_->look.height() == height &&
      targets_->scale == thickness_scale)
    return;
  targets_.reset();  // frees memory before allocating
  targets_.emplace(width, height, thickness_scale);
}

void LiquidPass::find_depth(const LiquidSplats& splats, int side, const RenderOptions& options,
                            float smoother, const gl::VertexArray& empty_array) {
  resize(side, side, fine_scale);
  window_ = {0, 0, side, side};
  clear();
  draw_balls(splats);
  smooth(options, smoother, empty_array);
}

void LiquidPass::find_surface(const LiquidSplats& splats, const Bounds& bounds, const LitScene& scene,
                              const PassContext& context, const RenderOptions& options,
                              const gl::VertexArray& empty_array) {
  resize(context.width, context.height, options.coarse ? coarse_scale : fine_scale);
  window_ = window_around(bounds, context);
  clear();
  keep_within(window_, 1);
  draw_balls(splats);
  smooth(options, 1, empty_array);
  keep_within(window_, targets_->scale);
  sum_thickness(splats, scene.depth);
  glDisable(GL_SCISSOR_TEST);
}

void LiquidPass::draw(const LiquidSplats& splats, const LitScene& scene, const ShadowPass& shadow,
                      const gl::VertexArray& empty_array) {
  scene.color.copy_to(targets_->copy.id(), 0, 0, scene.color.width(), scene.color.height());
  keep_within(window_, 1);
  shade(splats, scene, shadow, empty_array);
  glDisable(GL_SCISSOR_TEST);
}

}  // namespace souple::render
