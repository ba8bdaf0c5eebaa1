#include "render/passes/liquid_splats.h"

#include "render/gl/buffer.h"
#include "render/gl/vertex_array.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <unordered_map>
#include <vector>

namespace souple::render {

namespace {

enum Location : GLuint { center, radius, color, axis_x };

constexpr std::uint64_t frames_kept = 120;  // frames; lifetime of buffers that no list refers to
/// Radius of the clouds whose thickness is summed, in spacings: large enough for layers to look even.
constexpr float cloud_radius = 1.5f;

/// The buffers of one liquid or foam.
struct Buffers {
  gl::VertexArray balls, ellipsoids;
  gl::Buffer centers, axes;
  std::uint64_t version = 0, last_used = 0;
  GLsizei count = 0;
  bool never_uploaded = true, has_ellipsoids = false;
};

using BuffersByKey = std::unordered_map<std::uint64_t, Buffers>;

template <class Source>
struct Item {
  const Source* source = nullptr;
  const Buffers* buffers = nullptr;
};

/// Uploads the centers if they have changed; returns whether it did.
bool upload_centers(Buffers& buffers, std::span<const Vec3f> centers, std::uint64_t version) {
  const auto count = GLsizei(centers.size());
  if (!buffers.never_uploaded && buffers.version == version && buffers.count == count) return false;
  buffers.never_uploaded = false;
  buffers.version = version;
  buffers.count = count;
  if (count == 0) return false;
  buffers.centers.upload(centers);
  buffers.balls.attribute(buffers.centers, {.location = center, .components = 3, .divisor = 1});
  return true;
}

void upload(Buffers& buffers, const Foam& foam) {
  upload_centers(buffers, foam.centers, foam.version);
}

void upload(Buffers& buffers, const Liquid& liquid) {
  if (!upload_centers(buffers, liquid.centers, liquid.version)) return;
  buffers.has_ellipsoids = liquid.ellipsoids.size() == liquid.centers.size();
  if (!buffers.has_ellipsoids) return;
  buffers.axes.upload(liquid.ellipsoids);
  buffers.ellipsoids.attribute(buffers.centers, {.location = center, .components = 3, .divisor = 1});
  for (GLuint k = 0; k < 3; ++k) {
    buffers.ellipsoids.attribute(buffers.axes, {.location = axis_x + k,
                                                .components = 3,
                                                .stride = GLsizei(sizeof(Mat3f)),
                                                .offset = k * sizeof(Vec3f),
                                                .divisor = 1});
  }
}

template <class Source>
void update(std::span<const Source> sources, std::uint64_t frame, BuffersByKey& known,
            std::vector<Item<Source>>& items) {
  items.clear();
  for (const Source& source : sources) {
    Buffers& buffers = known[source.key];
    buffers.last_used = frame;
    upload(buffers, source);
    if (buffers.count > 0) items.push_back({&source, &buffers});
  }
  std::erase_if(known, [&](const auto& entry) { return entry.second.last_used + frames_kept < frame; });
}

void draw_instances(const gl::VertexArray& array, GLsizei count) {
  array.bind();
  glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, count);
}

/// k of liquid_thickness.frag.glsl: the integral of k (1 - q^2) over the ball, 8 pi k r^3 / 15, is the volume
/// of a particle.
constexpr float cloud_density = 15 / (8 * float(pi) * cloud_radius * cloud_radius * cloud_radius);

}  // namespace

struct LiquidSplats::Impl {
  void draw_depth() const;
  void draw_thickness(const gl::Program& program, bool from_sun) const;
  void draw_foam() const;
  void draw_pick() const;

  gl::Program depth{"sphere.vert.glsl", "liquid_depth.frag.glsl"};
  gl::Program ellipsoid_depth{"ellipsoid.vert.glsl", "liquid_depth.frag.glsl", {"ELLIPSOIDS"}};
  gl::Program thickness{"sphere.vert.glsl", "liquid_thickness.frag.glsl"};
  gl::Program sunlight{"sphere.vert.glsl", "liquid_thickness.frag.glsl", {"SUNLIGHT"}};
  gl::Program foam{"sphere.vert.glsl", "foam.frag.glsl"};
  gl::Program pick{"sphere.vert.glsl", "sphere.frag.glsl", {target_define(Target::pick)}};
  BuffersByKey liquid_buffers, foam_buffers;
  std::vector<Item<Liquid>> liquids;
  std::vector<Item<Foam>> foams;
  std::uint64_t frame = 0;
};

LiquidSplats::LiquidSplats() : impl_(std::make_unique<Impl>()) {}
LiquidSplats::~LiquidSplats() = default;

void LiquidSplats::update(std::span<const Liquid> liquids, std::span<const Foam> foams) {
  Impl& m = *impl_;
  ++m.frame;
  render::update(liquids, m.frame, m.liquid_buffers, m.liquids);
  render::update(foams, m.frame, m.foam_buffers, m.foams);
}

bool LiquidSplats::empty() const {
  return impl_->liquids.empty() && impl_->foams.empty();
}

bool LiquidSplats::casts_shadow() const {
  return std::any_of(impl_->liquids.begin(), impl_->liquids.end(),
                     [](const Item<Liquid>& item) { return item.source->casts_shadow; });
}

bool LiquidSplats::is_cloudy() const {
  return !impl_->foams.empty() ||
         std::any_of(impl_->liquids.begin(), impl_->liquids.end(), [](const Item<Liquid>& item) {
           return length_squared(item.source->look.scattering) > 0;
         });
}

Vec4 LiquidSplats::extinction() const {
  Vec3f sum{};
  bool first = true, equal = true;
  for (const auto& [liquid, buffers] : impl_->liquids) {
    const Vec3f of_this = liquid->look.absorption + liquid->look.scattering;
    equal = equal && (first || of_this == sum);
    sum = of_this;
    first = false;
  }
  return {sum.x, sum.y, sum.z, equal ? 1.0f : 0.0f};
}

void LiquidSplats::Impl::draw_depth() const {
  for (const auto& [liquid, buffers] : liquids) {
    const gl::Program& program = buffers->has_ellipsoids ? ellipsoid_depth : depth;
    program.use();
    program.set("look", Vec4{liquid->look.refractive_index, liquid->look.roughness, liquid->radius, 0});
    glVertexAttrib1f(radius, liquid->radius);
    draw_instances(buffers->has_ellipsoids ? buffers->ellipsoids : buffers->balls, buffers->count);
  }
}

void LiquidSplats::Impl::draw_thickness(const gl::Program& program, bool from_sun) const {
  program.use();
  for (const auto& [liquid, buffers] : liquids) {
    if (from_sun && !liquid->casts_shadow) continue;
    program.set("extinction", liquid->look.absorption + liquid->look.scattering);
    program.set("scattering", liquid->look.scattering);
    program.set("density", cloud_density);
    glVertexAttrib1f(radius, cloud_radius * liquid->spacing);
    draw_instances(buffers->balls, buffers->count);
  }
}

void LiquidSplats::Impl::draw_foam() const {
  foam.use();
  for (const auto& [cloud, buffers] : foams) {
    foam.set("strength", -std::log(1 - std::clamp(cloud->opacity, 0.0f, 0.999f)));
    glVertexAttrib1f(radius, cloud->radius);
    draw_instances(buffers->balls, buffers->count);
  }
}

void LiquidSplats::Impl::draw_pick() const {
  pick.use();
  for (const auto& [liquid, buffers] : liquids) {
    if (liquid->pick == 0) continue;
    pick.set("pick", liquid->pick);
    glVertexAttrib1f(radius, liquid->radius);
    draw_instances(buffers->balls, buffers->count);
  }
}

void LiquidSplats::draw(SplatTarget target, int scale) const {
  const Impl& m = *impl_;
  switch (target) {
    case SplatTarget::depth:
      m.draw_depth();
      break;
    case SplatTarget::thickness:
      m.thickness.use();
      m.thickness.set("scale", scale);
      m.draw_thickness(m.thickness, false);
      break;
    case SplatTarget::sunlight:
      m.draw_thickness(m.sunlight, true);
      break;
    case SplatTarget::foam:
      m.draw_foam();
      break;
    case SplatTarget::pick:
      m.draw_pick();
      break;
  }
  glBindVertexArray(0);
}

}  // namespace souple::render
