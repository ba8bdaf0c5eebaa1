#include "render/passes/glass.h"

namespace souple::render {

namespace {

constexpr int most_layers = 12;      // a ray through more walls passes the nearest unseen
constexpr int uncounted_layers = 4;  // where the last layer cannot be found out

int parts_of(int side, int scale) {
  return (side + scale - 1) / scale;
}

}  // namespace

GlassPass::Targets::Targets(int width, int height, int layer_scale)
    : scale(layer_scale),
      entry{gl::Texture(GL_RGBA32F, parts_of(width, scale), parts_of(height, scale)),
            gl::Texture(GL_RGBA32F, parts_of(width, scale), parts_of(height, scale))},
      look(GL_RGBA16F, parts_of(width, scale), parts_of(height, scale)),
      exit(GL_RGBA32F, parts_of(width, scale), parts_of(height, scale)),
      depth(GL_DEPTH_COMPONENT32F, parts_of(width, scale), parts_of(height, scale)),
      behind(GL_RGBA16F, width, height, GL_LINEAR),
      entry_target{gl::Framebuffer("the fronts of glass", {&entry[0], &look}, &depth),
                   gl::Framebuffer("the fronts of glass", {&entry[1], &look}, &depth)},
      exit_target("the backs of glass", {&exit}, &depth),
      copy("what is behind glass", {&behind}, nullptr) {}

GlassPass::GlassPass() {
  GLuint id = 0;
  glGenQueries(1, &id);
  query_ = gl::Handle<delete_query>(id);
}

/// The farthest fronts before the layer behind, and the nearest backs behind them. False where there are none.
bool GlassPass::find_layer(int layer, SurfacesPass& surfaces, PassContext& context) {
  const auto now = std::size_t(layer % 2);
  targets_->entry_target[now].bind();
  clear_color(0);
  clear_color(1);
  clear_depth(0);
  targets_->entry[1 - now].bind(gl::Unit::albedo);
  context.target = Target::glass_entry;
  context.layer = layer;
  glDepthFunc(GL_GREATER);
  const bool counts = gl::can_wait_for_queries();
  if (counts) glBeginQuery(GL_ANY_SAMPLES_PASSED, query_.id());
  surfaces.draw(context);
  if (counts) glEndQuery(GL_ANY_SAMPLES_PASSED);
  glDepthFunc(GL_LEQUAL);
  GLuint any = 1;
  if (counts) glGetQueryObjectuiv(query_.id(), GL_QUERY_RESULT, &any);
  if (any == 0) return false;
  targets_->exit_target.bind();
  clear_color(0);
  clear_depth(1);
  targets_->entry[now].bind(gl::Unit::albedo);
  context.target = Target::glass_exit;
  surfaces.draw(context);
  return true;
}

void GlassPass::draw(GlassPart part, const LitScene& scene, const Bounds& bounds, const Window& liquids,
                     SurfacesPass& surfaces, PassContext context, bool coarse,
                     const gl::VertexArray& empty_array) {
  const int scale = coarse ? 2 : 1;
  if (!targets_ || targets_->behind.width() != context.width || targets_->behind.height() != context.height ||
      targets_->scale != scale) {
    targets_.reset();  // frees memory before allocating
    targets_.emplace(context.width, context.height, scale);
  }
  context.glass_scale = scale;
  context.glass_part = static_cast<float>(part);
  const Window around = window_around(bounds, context);
  const Window window = part == GlassPart::behind_liquids ? common_part(around, liquids) : around;
  if (window.width <= 0 || window.height <= 0) return;
  const int layers = gl::can_wait_for_queries() ? most_layers : uncounted_layers;
  for (int layer = 0; layer < layers; ++layer) {
    keep_within(window, scale);
    scene.depth.bind(gl::Unit::depth);
    glEnable(GL_DEPTH_TEST);
    glDepthMask(GL_TRUE);
    const bool found = find_layer(layer, surfaces, context);
    glDisable(GL_DEPTH_TEST);
    if (!found) break;
    // Rays may leave the window; only the first copy needs what is outside.
    if (layer == 0) glDisable(GL_SCISSOR_TEST);
    scene.color.copy_to(targets_->copy.id(), 0, 0, scene.color.width(), scene.color.height());
    keep_within(window, 1);
    scene.color.bind();
    glDepthMask(GL_FALSE);
    targets_->behind.bind(gl::Unit::color);
    targets_->look.bind(gl::Unit::liquid_look);
    targets_->exit.bind(gl::Unit::liquid_optics);
    const gl::Program& program = shade_.of(scene.has_panorama);
    program.use();
    program.set("part", context.glass_part);
    program.set("glass_scale", static_cast<float>(scale));
    program.set("steps", coarse ? 1 : 3);
    empty_array.bind();
    draw_screen();
    glDepthMask(GL_TRUE);
  }
  glDisable(GL_SCISSOR_TEST);
}

}  // namespace souple::render
