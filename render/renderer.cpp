#include "render/renderer.h"

#include "render/gl/buffer.h"
#include "render/gl/framebuffer.h"
#include "render/gl/program.h"
#include "render/gl/vertex_array.h"
#include "render/passes/caustics.h"
#include "render/passes/finish.h"
#include "render/passes/glass.h"
#include "render/passes/labels.h"
#include "render/passes/lines.h"
#include "render/passes/liquid.h"
#include "render/passes/occlusion.h"
#include "render/passes/pass_context.h"
#include "render/passes/pick.h"
#include "render/passes/shadow.h"
#include "render/passes/sky_program.h"
#include "render/passes/spheres.h"
#include "render/passes/surfaces.h"
#include "render/sky.h"
#include "souple/error.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>
#include <string>

#include <fmt/core.h>

namespace souple::render {

namespace {

constexpr int max_side = 8192;
constexpr float haze_reach = 20;  ///< distance at which haze hides the floor, in radii of the scene

void require_extensions() {
  const int version = gl::version();
  if (gl::is_es() && version < 30) throw Error("the renderer needs OpenGL ES 3.0; this context has less");
  if (!gl::is_es() && version < 33) throw Error("the renderer needs OpenGL 3.3; this context has less");
  // Desktop OpenGL can draw into floating-point buffers since 3.0.
  if (gl::is_es() && !gl::has_extension("GL_EXT_color_buffer_float")) {
    throw Error(
        "the renderer needs the OpenGL ES extension EXT_color_buffer_float, which this driver lacks; Mesa's "
        "llvmpipe has it (LIBGL_ALWAYS_SOFTWARE=1, Debian package libgl1-mesa-dri)");
  }
}

// Resources that depend only on the size of the picture.
struct Targets {
  int width, height;
  gl::Texture albedo, normal, depth, color;
  // No pass draws into a texture that it reads: lighting reads the depth, so only lines have it attached.
  gl::Framebuffer material, lighting, lines;

  Targets(int w, int h)
      : width(w),
        height(h),
        albedo(GL_RGBA8, w, h),
        normal(GL_RGBA16F, w, h),
        depth(GL_DEPTH_COMPONENT32F, w, h),
        color(GL_RGBA16F, w, h),
        material("materials", {&albedo, &normal}, &depth),
        lighting("light", {&color}, nullptr),
        lines("lines", {&color}, &depth) {}
};

// Framebuffer of pictures that are read back to memory.
struct Canvas {
  gl::Texture color;
  gl::Framebuffer target;

  Canvas(int width, int height) : color(GL_RGBA8, width, height), target("a picture", {&color}, nullptr) {}
};

// Fractional part of i times powers of the inverse plastic number: evenly distributed points (Roberts 2018,
// R2 sequence).
std::array<float, 2> r2_point(int i) {
  const double x = 0.5 + 0.7548776662466927 * i, y = 0.5 + 0.5698402909980532 * i;
  return {float(x - std::floor(x)), float(y - std::floor(y))};
}

// Position in the sun's disk for a sample, on Vogel's spiral: all samples together cover the disk evenly.
std::array<float, 2> sample_on_disk(int i, int count) {
  if (count <= 1) return {0, 0};
  const double radius = std::sqrt((i + 0.5) / count), angle = 2.399963229728653 * i;
  return {float(radius * std::cos(angle)), float(radius * std::sin(angle))};
}

// Position on the lens for a sample: the points of the sun's disk, in another order, so that the two are independent.
std::array<float, 2> sample_on_lens(int i, int count) {
  int stride = std::max(static_cast<int>(0.618 * count), 1);
  while (std::gcd(stride, count) != 1) ++stride;
  return sample_on_disk(static_cast<int>((static_cast<long long>(i) * stride + count / 3) % count), count);
}

/// The camera at a point of the lens. Its picture is sheared so that the plane in focus stays where it is.
struct LensView {
  Camera camera;
  float shear_x = 0, shear_y = 0;  ///< tangents of the angles to the plane's center

  LensView(const Camera& middle, const RenderOptions& options, int sample) : camera(middle) {
    if (!(options.aperture > 0) || !(options.focus > 0) || options.samples <= 1) return;
    const std::array<float, 2> point = sample_on_lens(sample, options.samples);
    const float across = 0.5f * options.aperture * point[0], above = 0.5f * options.aperture * point[1];
    const Vec3f offset = middle.right() * across + middle.up() * above;
    camera.from += offset;
    camera.to += offset;
    shear_x = across / options.focus;
    shear_y = above / options.focus;
  }
};

// `all` is the bounding box of the whole list.
Bounds bounds_of_casters(const DrawList& list, const Bounds& all) {
  const auto casts = [](const auto& object) { return object.casts_shadow; };
  if (std::all_of(list.surfaces.begin(), list.surfaces.end(), casts) &&
      std::all_of(list.spheres.begin(), list.spheres.end(), casts) &&
      std::all_of(list.liquids.begin(), list.liquids.end(), casts) && list.foams.empty()) {
    return all;
  }
  DrawList casters;
  for (const Surface& surface : list.surfaces) {
    if (surface.casts_shadow) casters.surfaces.push_back(surface);
  }
  for (const Spheres& spheres : list.spheres) {
    if (spheres.casts_shadow) casters.spheres.push_back(spheres);
  }
  for (const Liquid& liquid : list.liquids) {
    if (liquid.casts_shadow) casters.liquids.push_back(liquid);
  }
  return casters.bounds();
}

Bounds bounds_of_liquids(const DrawList& list) {
  DrawList liquids;
  liquids.liquids = list.liquids;
  liquids.foams = list.foams;
  return liquids.bounds();
}

Bounds bounds_of_glass(const DrawList& list) {
  DrawList glass;
  for (const Surface& surface : list.surfaces)
    if (surface.look.glass) glass.surfaces.push_back(surface);
  return glass.bounds();
}

Vec4 vec4(const Vec3f& v, float w) {
  return {v.x, v.y, v.z, w};
}
Vec4 vec4(const Color& c, float scale) {
  return {c.r * scale, c.g * scale, c.b * scale, scale};
}

void set_sky(Frame& frame, const Sky& sky, float exposure) {
  frame.sky = vec4(sky.zenith * exposure, exposure);
  frame.horizon = vec4(sky.horizon * exposure, exposure);
  frame.floor_light = vec4(sky.floor * exposure, exposure);
  frame.irradiance = sky_irradiance(sky);
  for (Vec4& c : frame.irradiance) c = {c.x * exposure, c.y * exposure, c.z * exposure, 0};
}

void set_environment(Frame& frame, const Environment& environment, float exposure) {
  const EnvironmentOptions& options = environment.options();
  frame.sky.w = options.strength * exposure;
  frame.horizon.w = options.rotation / float(2 * pi);
  frame.floor_light.w = options.background ? 1.0f : 0.0f;
  frame.to_sun.w = options.sun * exposure;
  for (std::size_t i = 0; i < frame.irradiance.size(); ++i) {
    const Vec4& c = environment.irradiance()[i];
    frame.irradiance[i] = {c.x * exposure, c.y * exposure, c.z * exposure, 0};
  }
}

void require_size(int width, int height) {
  if (width >= 1 && height >= 1 && width <= max_side && height <= max_side) return;
  throw Error(
      fmt::format("a picture of {} x {} pixels: expected each side in [1, {}]", width, height, max_side));
}

constexpr std::array<std::string_view, liquid_filter_count> liquid_filter_names{"none", "curvature-flow",
                                                                                "narrow-range"};

}  // namespace

std::string_view liquid_filter_name(LiquidFilter filter) {
  return liquid_filter_names[std::size_t(filter)];
}

struct Renderer::Impl {
  Impl() { require_extensions(); }

  gl::VertexArray empty_array;  // for draw_screen
  gl::Buffer frame_buffer;
  gl::Program ground{"ray.vert.glsl", "ground.frag.glsl"};
  SkyProgram lighting{"lighting.frag.glsl"};
  SkyProgram lighting_with_liquids{"lighting.frag.glsl", {"LIQUIDS"}};
  // Made when a list has caustics.
  std::optional<SkyProgram> lighting_with_caustics;
  std::optional<CausticsPass> caustics;
  SkyMap sky_map;
  SurfacesPass surfaces;
  SpheresPass spheres;
  LiquidSplats liquid_splats;
  LiquidPass liquids;
  GlassPass glass;
  LinesPass lines;
  ShadowPass shadow;
  OcclusionPass occlusion;
  FinishPass finish;
  LabelsPass labels;
  PickPass picking;
  std::optional<Targets> targets;
  std::optional<Canvas> canvas;

  Targets& targets_of(int width, int height);
  bool filters_sunlight() const { return liquid_splats.casts_shadow() || surfaces.glass_casts_shadow(); }
  Frame frame(const DrawList& list, const Camera& camera, const RenderOptions& options, const Bounds& bounds,
              int width, int height, int sample) const;
  PassContext begin_picking(const DrawList& list, const Camera& camera, int width, int height);
  void draw_material(const DrawList& list, const PassContext& context);
  bool has_caustics(const DrawList& list) const {
    return list.light.caustics && liquid_splats.casts_shadow();
  }
  void draw_caustics(const DrawList& list, const Frame& frame);
  void draw_lighting(const DrawList& list);
  void draw_clear(const DrawList& list, const PassContext& context, const RenderOptions& options);
  void draw_lines(const DrawList& list, const PassContext& context);
  void draw_sample(const DrawList& list, const PassContext& context, const Frame& frame,
                   const RenderOptions& options);
  void upload(const DrawList& list);
  void draw(const ListAt& list_at, int steps, const Camera& camera, const RenderOptions& options,
            std::uint32_t framebuffer);
  Image picture(const ListAt& list_at, int steps, const Camera& camera, const RenderOptions& options,
                int width, int height);
  void draw_one(const DrawList& list, const Camera& camera, const RenderOptions& options, int sample);
};

namespace {

void default_state() {
  glDisable(GL_BLEND);
  glDisable(GL_DEPTH_TEST);
  glDisable(GL_CULL_FACE);
  glDisable(GL_SCISSOR_TEST);
  glDisable(GL_STENCIL_TEST);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  glDepthMask(GL_TRUE);
  glDepthFunc(GL_LEQUAL);
}

}  // namespace

Targets& Renderer::Impl::targets_of(int width, int height) {
  if (!targets || targets->width != width || targets->height != height) {
    targets.reset();  // frees memory before allocating
    targets.emplace(width, height);
  }
  return *targets;
}

Frame Renderer::Impl::frame(const DrawList& list, const Camera& camera, const RenderOptions& options,
                            const Bounds& bounds, int width, int height, int sample) const {
  Frame f;
  const auto w = float(width), h = float(height);
  f.view = camera.view();
  f.projection = camera.projection(w / h, bounds);
  const std::array<float, 2> offset = r2_point(sample);
  if (options.samples > 1) {
    f.projection.m[8] += (2 * offset[0] - 1) / w;
    f.projection.m[9] += (2 * offset[1] - 1) / h;
  }
  f.inverse_view = inverse(f.view);
  f.inverse_projection = inverse(f.projection);
  f.eye = vec4(camera.from, 1);
  f.size = {w, h, 1 / w, 1 / h};
  f.to_sun = vec4(normalized(list.light.to_sun), list.light.sun * options.exposure);
  set_sky(f, sky_of(list.light, list.ground), options.exposure);
  if (list.light.environment) set_environment(f, *list.light.environment, options.exposure);
  const float reach = std::max(bounds.radius(), camera.distance());
  f.ground = {list.ground.height, std::max(list.ground.tile, 1e-6f), list.ground.shown ? 1.0f : 0.0f,
              haze_reach * reach};
  f.ground_color = vec4(list.ground.color, 1);
  f.ground_second = vec4(list.ground.second, 1);
  f.sun_size.y = options.samples > 1 ? 1.5f / std::sqrt(float(options.samples)) : 1.0f;
  f.sun_size.z = options.tone_curve ? 1.0f : 0.0f;
  f.sun_size.w = options.coarse ? 1.0f : 0.0f;
  f.sample_info = {float(sample), float(options.samples), options.samples > 1 ? offset[0] : 0.0f, 0};
  OcclusionPass::aim(f, bounds, options.ambient_occlusion);
  return f;
}

void Renderer::Impl::draw_material(const DrawList& list, const PassContext& context) {
  targets->material.bind();
  glEnable(GL_DEPTH_TEST);
  clear_color(0);
  clear_color(1);
  clear_depth(1);
  surfaces.draw(context);
  spheres.draw(context);
  if (list.ground.shown) {
    ground.use();
    empty_array.bind();
    draw_screen();
  }
}

/// Onto the floor, or without one onto the level of the liquids' lowest point.
void Renderer::Impl::draw_caustics(const DrawList& list, const Frame& frame) {
  if (!caustics) {
    caustics.emplace();
    lighting_with_caustics.emplace("lighting.frag.glsl", std::vector<std::string>{"LIQUIDS", "CAUSTICS"});
  }
  const Bounds bounds = bounds_of_liquids(list);
  const float height = list.ground.shown ? list.ground.height : bounds.lo.y;
  caustics->draw(frame, liquid_splats, bounds, height, empty_array);
}

void Renderer::Impl::draw_lighting(const DrawList& list) {
  targets->lighting.bind();
  glDisable(GL_DEPTH_TEST);
  glDepthMask(GL_FALSE);
  targets->albedo.bind(gl::Unit::albedo);
  targets->normal.bind(gl::Unit::normal);
  targets->depth.bind(gl::Unit::depth);
  shadow.bind();
  occlusion.bind(targets->normal);
  const bool refracts = has_caustics(list);
  SkyProgram& sky =
      refracts ? *lighting_with_caustics : (filters_sunlight() ? lighting_with_liquids : lighting);
  const gl::Program& program = sky.of(list.light.environment != nullptr);
  program.use();
  if (refracts) caustics->bind(program);
  empty_array.bind();
  draw_screen();
  glDepthMask(GL_TRUE);
}

/// Liquids and glass.
void Renderer::Impl::draw_clear(const DrawList& list, const PassContext& context,
                                const RenderOptions& options) {
  const LitScene scene{targets->normal, targets->depth, targets->lighting, list.light.environment != nullptr};
  const Bounds walls = surfaces.has_glass() ? bounds_of_glass(list) : Bounds{};
  const auto draw_glass = [&](GlassPart part) {
    if (!surfaces.has_glass() || (options.coarse && part == GlassPart::behind_liquids)) return;
    if (part != GlassPart::all) liquids.bind_surface();
    glass.draw(part, scene, walls, liquids.window(), surfaces, context, options.coarse, empty_array);
  };
  if (liquid_splats.empty()) return draw_glass(GlassPart::all);
  liquids.find_surface(liquid_splats, bounds_of_liquids(list), scene, context, options, empty_array);
  draw_glass(GlassPart::behind_liquids);
  liquids.draw(liquid_splats, scene, shadow, empty_array);
  draw_glass(GlassPart::before_liquids);
}

void Renderer::Impl::draw_lines(const DrawList& list, const PassContext& context) {
  targets->lines.bind();
  glDepthMask(GL_FALSE);
  glEnable(GL_DEPTH_TEST);
  lines.draw(list.lines, context);
  glDisable(GL_DEPTH_TEST);
  lines.draw(list.top_lines, context);
  glDepthMask(GL_TRUE);
}

/// One sample, from an empty buffer to linear color. The shadow map is drawn, `frame` bound.
void Renderer::Impl::draw_sample(const DrawList& list, const PassContext& context, const Frame& frame,
                                 const RenderOptions& options) {
  draw_material(list, context);
  if (frame.sample_info.w != 0) occlusion.draw(targets->normal, targets->depth, empty_array);
  if (list.light.environment) sky_map.bind(list.light.environment);
  draw_lighting(list);
  draw_clear(list, context, options);
  draw_lines(list, context);
}

void Renderer::Impl::upload(const DrawList& list) {
  surfaces.update(list.surfaces);
  spheres.update(list.spheres);
  liquid_splats.update(list.liquids, list.foams);
}

/// Draws one sample and adds it to the others.
void Renderer::Impl::draw_one(const DrawList& list, const Camera& camera, const RenderOptions& options,
                              int sample) {
  const int samples = std::max(options.samples, 1), width = targets->width, height = targets->height;
  const Bounds bounds = list.bounds(), casters = bounds_of_casters(list, bounds);
  const LensView lens(camera, options, sample);
  Frame at = frame(list, lens.camera, options, bounds, width, height, sample);
  at.projection.m[8] -= at.projection.m[0] * lens.shear_x;
  at.projection.m[9] -= at.projection.m[5] * lens.shear_y;
  at.inverse_projection = inverse(at.projection);
  const std::array<float, 2> sun = sample_on_disk(sample, samples);
  shadow.aim(at, list.light, options.shadows ? casters : Bounds{}, sun[0], sun[1]);
  shadow.draw(at, surfaces, spheres);
  if (at.shadow_size.w != 0 && filters_sunlight()) shadow.draw_light(liquid_splats, surfaces, options.coarse);
  if (has_caustics(list)) draw_caustics(list, at);
  bind_frame(frame_buffer, at);
  draw_sample(list, {width, height, Target::material, at.view, at.projection, lens.camera.from}, at, options);
  if (samples > 1) finish.add(targets->color, sample == 0, empty_array);
}

/// The picture from lists at `steps` times, into a framebuffer.
void Renderer::Impl::draw(const ListAt& list_at, int steps, const Camera& camera,
                          const RenderOptions& options, std::uint32_t framebuffer) {
  default_state();
  const int samples = std::max(options.samples, 1);
  steps = std::clamp(samples, 1, steps);
  const DrawList* list = nullptr;
  for (int sample = 0, last_step = -1; sample < samples; ++sample) {
    if (const int step = static_cast<int>(std::int64_t{sample} * steps / samples); step != last_step) {
      list = &list_at((static_cast<float>(step) + 0.5f) / static_cast<float>(steps));
      upload(*list);
      last_step = step;
    }
    draw_one(*list, camera, options, sample);
  }
  finish.draw(targets->color, samples, framebuffer, empty_array);
  if (options.labels) labels.draw(list->labels, targets->width, targets->height);
  default_state();
  glBindVertexArray(0);
  glUseProgram(0);
}

/// Draws the picture into memory.
Image Renderer::Impl::picture(const ListAt& list_at, int steps, const Camera& camera,
                              const RenderOptions& options, int width, int height) {
  require_size(width, height);
  targets_of(width, height);
  if (!canvas || canvas->target.width() != width || canvas->target.height() != height) {
    canvas.reset();
    canvas.emplace(width, height);
  }
  draw(list_at, steps, camera, options, canvas->target.id());
  return read_framebuffer(canvas->target.id(), width, height);
}

Image read_framebuffer(std::uint32_t framebuffer, int width, int height) {
  Image image(width, height);
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
  glPixelStorei(GL_PACK_ALIGNMENT, 4);
  glReadPixels(0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, image.pixels.data());
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  const std::size_t row = 4 * std::size_t(width);
  for (int y = 0; y < height / 2; ++y)  // OpenGL's rows begin at the bottom
    std::swap_ranges(image.at(0, y), image.at(0, y) + row, image.at(0, height - 1 - y));
  return image;
}

Renderer::Renderer() : impl_(std::make_unique<Impl>()) {}
Renderer::~Renderer() = default;

void Renderer::draw(const DrawList& list, const Camera& camera, const RenderOptions& options, int width,
                    int height, std::uint32_t framebuffer) {
  if (width <= 0 || height <= 0) return;
  require_size(width, height);
  impl_->targets_of(width, height);
  impl_->draw([&](float) -> const DrawList& { return list; }, 1, camera, options, framebuffer);
}

void Renderer::draw_labels(const DrawList& list, int width, int height) {
  impl_->labels.draw(list.labels, width, height);
  default_state();
  glUseProgram(0);
}

Image Renderer::picture(const DrawList& list, const Camera& camera, const RenderOptions& options, int width,
                        int height) {
  return impl_->picture([&](float) -> const DrawList& { return list; }, 1, camera, options, width, height);
}

Image Renderer::moving_picture(const ListAt& list_at, const Camera& camera, const RenderOptions& options,
                               int width, int height) {
  return impl_->picture(list_at, max_shutter_steps, camera, options, width, height);
}

PassContext Renderer::Impl::begin_picking(const DrawList& list, const Camera& camera, int width, int height) {
  default_state();
  surfaces.update(list.surfaces);
  spheres.update(list.spheres);
  liquid_splats.update(list.liquids, {});
  const Frame picked = frame(list, camera, {}, list.bounds(), width, height, 0);
  bind_frame(frame_buffer, picked);
  return {width, height, Target::pick, picked.view, picked.projection, camera.from};
}

Picked Renderer::pick(const DrawList& list, const Camera& camera, int x, int y, int width, int height) {
  if (x < 0 || y < 0 || x >= width || y >= height) return {};
  require_size(width, height);
  Impl& m = *impl_;
  const PassContext context = m.begin_picking(list, camera, width, height);
  const Picked picked = m.picking.pick(list, {m.surfaces, m.spheres, m.liquid_splats}, context, x, y);
  default_state();
  return picked;
}

PickImage Renderer::pick_image(const DrawList& list, const Camera& camera, int width, int height) {
  require_size(width, height);
  Impl& m = *impl_;
  const PassContext context = m.begin_picking(list, camera, width, height);
  PickImage image = m.picking.image(list, {m.surfaces, m.spheres, m.liquid_splats}, context);
  default_state();
  return image;
}

LiquidImage Renderer::liquid_image(const DrawList& list, const Camera& camera, RenderOptions options,
                                   int width, int height) {
  LiquidImage image{width, height, {}, {}};
  const std::size_t count = std::size_t(std::max(width, 0)) * std::size_t(std::max(height, 0));
  options.samples = 1;
  picture(list, camera, options, width, height);
  if (impl_->liquid_splats.empty()) {
    image.depth.resize(count);
    image.thickness.resize(count);
    return image;
  }
  image.depth = impl_->liquids.read_depth();
  image.thickness = impl_->liquids.read_thickness();
  return image;
}

}  // namespace souple::render
