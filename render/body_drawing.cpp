#include "render/body_drawing.h"

#include "render/looks.h"
#include "souple/geometry/rest_frames.h"

#include <algorithm>
#include <cmath>

namespace souple::render {
namespace {

/// Mean edge length of the first few hundred triangles, from which the size of marks follows. [m]
float mean_edge_length(const Body& body) {
  double sum = 0;
  const std::size_t count = std::min<std::size_t>(body.triangles.size(), 300);
  for (const Triangle& t : body.triangles.first(count))
    for (std::size_t k = 0; k < 3; ++k)
      sum += static_cast<double>(length(body.positions[t[k]] - body.positions[t[(k + 1) % 3]]));
  return count > 0 ? static_cast<float>(sum / static_cast<double>(3 * count)) : 2 * body.radius;
}

float polyline_length(std::span<const Vec3f> points) {
  float sum = 0;
  for (std::size_t i = 0; i + 1 < points.size(); ++i) sum += length(points[i + 1] - points[i]);
  return sum;
}

bool is_measured(Display display) {
  return display == Display::strain || display == Display::speed || display == Display::normals;
}

}  // namespace

BodyDrawing::BodyDrawing(const Body& body, std::uint32_t index, std::uint64_t key)
    : kind_(body.kind),
      index_(index),
      chosen_(body.color),
      key_(key),
      vertices_(body.positions.size()),
      triangle_count_(body.triangles.size()),
      triangles_(body.triangles.data()),
      mean_edge_(mean_edge_length(body)),
      density_(body.density) {
  if (is_line()) tube_.resize(vertices_, body.radius, polyline_length(body.positions));
  const bool has_creases = traits().shape == ObjectShape::solid || traits().driven || traits().rigid;
  if (has_creases && body.rest.size() == vertices_) creased_ = CreasedSurface(body.rest, body.triangles);
  if (traits().rolls) grain_colors_ = grain_colors(vertices_, index_, chosen_);
}

bool BodyDrawing::fits(const Body& body) const {
  return body.kind == kind_ && body.color == chosen_ && body.positions.size() == vertices_ &&
         body.triangles.data() == triangles_ && body.triangles.size() == triangle_count_;
}

Bounds BodyDrawing::bounds(const Body& body) const {
  Bounds result;
  for (const Vec3f& x : body.positions) result.add(x, body.radius);
  return result;
}

bool BodyDrawing::draws_particles(const DrawContext& context) const {
  const Display display = context.options.display;
  return display == Display::particles ||
         (display == Display::lattice && traits().shape == ObjectShape::solid && context.has_world);
}

bool BodyDrawing::draws_liquid(const DrawContext& context) const {
  return traits().flows && triangle_count_ == 0 && !draws_particles(context) &&
         !is_measured(context.options.display) && context.options.constraints == ConstraintDisplay::none;
}

Look BodyDrawing::look(const DrawContext& context) const {
  const Display display = context.options.display;
  Look result = base_look();
  if (!colors_.empty() && is_measured(display)) return measured_look();
  const bool behind_lines = context.options.constraints != ConstraintDisplay::none ||
                            display == Display::contacts || display == Display::lattice ||
                            is_measured(display);
  if (behind_lines) return pale(result);
  if (display == Display::shaded) result.checker_size = 1;
  return result;
}

Look BodyDrawing::base_look() const {
  // A rope's particles are more visible in a palette color than in the color of hemp.
  const bool as_balls = as_particles_ && is_line();
  const std::optional<Color> chosen =
      traits().flows ? std::optional(liquid_color(density_, chosen_)) : chosen_;
  return body_look(as_balls ? ObjectKind::soft_body : kind_, index_, chosen);
}

void BodyDrawing::draw(const Body& body, std::uint32_t pick, std::span<const float> rope_strain,
                       const DrawContext& context) {
  if (body.positions.empty()) return;
  as_particles_ = draws_particles(context);
  refresh(body, rope_strain, context);
  if (as_particles_) {
    draw_particles(body, pick, context);
  } else if (is_line()) {
    draw_tube(pick, context);
  } else if (draws_liquid(context)) {
    draw_liquid(body, pick, context);
  } else if (traits().rolls || body.triangles.empty()) {
    draw_grains(body, pick, context);
  } else {
    draw_surface(body, pick, context);
  }
}

/// Rebuilds the parts that depend on the frame or on the display options; does nothing if neither has
/// changed.
void BodyDrawing::refresh(const Body& body, std::span<const float> rope_strain, const DrawContext& context) {
  const DisplayOptions& options = context.options;
  UploadedState now{context.frame, body.positions.data(), options.display};
  now.pale = options.constraints != ConstraintDisplay::none;
  now.radius = body.radius;
  if (draws_liquid(context)) now.splats = options.liquid_splats;
  if (options.display == Display::strain) now.largest = options.max_strain;
  if (options.display == Display::speed) now.largest = options.max_speed;
  if (version_ > 0 && now == uploaded_) return;
  uploaded_ = now;
  ++version_;
  if (is_line() && !as_particles_) tube_.update(body.positions, body.radius);
  if (creased_.has_creases()) creased_.update(body.positions);
  if (now.splats == SplatShape::ellipsoids) shape_splats(body, context.threads);
  set_colors(body, rope_strain, context);
  if (!creased_.has_creases() || colors_.empty()) return;
  colors_.reserve(creased_.source().size());  // the duplicates follow the vertices themselves
  for (const std::uint32_t v : creased_.source().subspan(colors_.size())) colors_.push_back(colors_[v]);
}

void BodyDrawing::shape_splats(const Body& body, Threads& threads) {
  const float spacing = 2 * body.radius;
  if (!splats_ || splats_->spacing() != spacing) splats_.emplace(spacing);
  splats_->build(body.positions, threads);
}

/// Per vertex: the value that a measuring display shows; empty if unknown.
std::span<const float> BodyDrawing::values(const Body& body, std::span<const float> rope_strain,
                                           Display display) {
  if (display == Display::speed) {
    if (body.velocities.size() != body.positions.size()) return {};
    values_.resize(body.velocities.size());
    for (std::size_t i = 0; i < values_.size(); ++i) values_[i] = length(body.velocities[i]);
    return values_;
  }
  if (is_line()) return rope_strain;
  if (traits().driven) return {};  // an obstacle has no strain
  if (body.triangles.empty() || body.rest.size() != body.positions.size()) return {};
  if (!has_strain_) strain_ = EdgeStrain(body.rest, body.triangles);
  has_strain_ = true;
  strain_.evaluate(body.positions, values_);
  return values_;
}

void BodyDrawing::set_colors(const Body& body, std::span<const float> rope_strain,
                             const DrawContext& context) {
  colors_.clear();
  const Display display = context.options.display;
  const bool is_tube = is_line();
  if (display == Display::normals) color_normals(is_tube ? tube_.normals() : body.normals, colors_);
  if (display != Display::strain && display != Display::speed) return;
  const std::span<const float> known = values(body, rope_strain, display);
  if (known.size() != body.positions.size()) return;
  if (!is_tube) return context.heat.color(known, uploaded_.largest, colors_);
  std::vector<float> along(tube_.positions().size());
  for (std::size_t v = 0; v < along.size(); ++v) {
    const float parameter = tube_.parameter(v);
    const auto i = static_cast<std::size_t>(parameter);
    const float part = parameter - static_cast<float>(i);
    along[v] = known[i] * (1 - part) + known[std::min(i + 1, known.size() - 1)] * part;
  }
  context.heat.color(along, uploaded_.largest, colors_);
}

void BodyDrawing::draw_surface(const Body& body, std::uint32_t pick, const DrawContext& context) {
  Look seen = look(context);
  const bool woven = traits().shape == ObjectShape::surface && !traits().driven && !traits().rigid;
  if (woven && seen.weave > 0) seen = finished(seen, body.fabric, body.print);
  if (seen.checker_size > 0 && woven && checker_.texture.empty() && body.rest.size() == vertices_) {
    checker_ = cloth_checker(body.rest, body.triangles);
    ++topology_;
  }
  Surface surface;
  surface.key = key_;
  surface.topology = topology_;
  surface.version = version_;
  const bool creased = creased_.has_creases();
  surface.positions = creased ? creased_.positions() : body.positions;
  surface.normals = creased ? creased_.normals() : body.normals;
  surface.triangles = creased ? creased_.triangles() : body.triangles;
  surface.texture = checker_.texture;
  if (seen.checker_size > 0) add_picture(body, surface);
  surface.colors = colors_;
  surface.look = body.glass && context.options.display <= Display::wireframe ? glass_look(chosen_) : seen;
  if (checker_.texture.empty()) surface.look.checker_size = 0;
  surface.wireframe = context.options.wireframe || context.options.display == Display::wireframe;
  surface.pick = pick;
  context.list.surfaces.push_back(surface);
  if (context.options.display == Display::normals) draw_normals(body, context.list);
}

/// A picture over the whole cloth, placed by its UVs.
void BodyDrawing::add_picture(const Body& body, Surface& surface) {
  if (!body.picture || body.mesh == nullptr || creased_.has_creases()) return;
  if (uvs_.empty()) uvs_ = triangle_uvs(*body.mesh).value_or(std::vector<CornerUvs>{});
  surface.print = body.picture;
  surface.uvs = uvs_;
}

void BodyDrawing::draw_tube(std::uint32_t pick, const DrawContext& context) {
  context.list.surfaces.push_back(
      {.key = key_,
       .topology = topology_,
       .version = version_,
       .positions = tube_.positions(),
       .normals = tube_.normals(),
       .triangles = tube_.triangles(),
       .texture = tube_.texture(),
       .colors = colors_,
       .look = look(context),
       .wireframe = context.options.wireframe || context.options.display == Display::wireframe,
       .pick = pick});
}

void BodyDrawing::draw_liquid(const Body& body, std::uint32_t pick, const DrawContext& context) {
  // Half the edge of a cube with the liquid's volume: its color does not depend on the size or the resolution
  // of the scene. A liquid of few particles, which may grow, gets at least some spacings.
  const float spacing = 2 * body.radius;
  const float edge = std::max(std::cbrt(static_cast<float>(body.positions.size())), 16.0f) * spacing;
  Liquid liquid;
  liquid.key = key_ + 1;
  liquid.version = version_;
  liquid.centers = body.positions;
  liquid.spacing = spacing;
  liquid.radius = 0.75f * spacing;
  if (uploaded_.splats == SplatShape::ellipsoids) {
    liquid.centers = splats_->centers();
    liquid.ellipsoids = splats_->axes();
  }
  liquid.look = liquid_look(density_, 0.5f * edge, chosen_);
  liquid.pick = pick;
  context.list.liquids.push_back(liquid);
  if (body.foam.empty()) return;
  context.list.foams.push_back(
      {.key = key_, .version = version_, .centers = body.foam, .radius = 0.16f * spacing, .opacity = 0.38f});
}

void BodyDrawing::draw_grains(const Body& body, std::uint32_t pick, const DrawContext& context) {
  Spheres spheres;
  spheres.key = key_ + 1;
  spheres.version = version_;
  spheres.centers = body.positions;
  spheres.radius = body.radius;
  spheres.look = look(context);
  const bool as_sand =
      context.options.display <= Display::wireframe && context.options.constraints == ConstraintDisplay::none;
  if (as_sand) spheres.colors = grain_colors_;
  if (!colors_.empty()) spheres.colors = colors_;
  spheres.pick = pick;
  context.list.spheres.push_back(spheres);
}

void BodyDrawing::draw_particles(const Body& body, std::uint32_t pick, const DrawContext& context) {
  Spheres spheres;
  spheres.key = key_ + 1;
  spheres.version = version_;
  const bool of_world = context.has_world;
  spheres.centers = of_world ? std::span<const Vec3f>(particles_.centers) : body.positions;
  if (of_world) spheres.radii = particles_.radii;
  spheres.radius = body.radius;
  spheres.look = base_look();
  if (context.options.constraints != ConstraintDisplay::none) spheres.look = pale(spheres.look);
  spheres.pick = pick;
  context.list.spheres.push_back(spheres);
}

void BodyDrawing::draw_normals(const Body& body, DrawList& list) const {
  if (body.normals.size() != body.positions.size()) return;
  const PackedColor ink = pack(srgb(0x20262c));
  for (std::size_t i = 0; i < body.positions.size(); ++i)
    list.lines.push_back(
        {body.positions[i], body.positions[i] + body.normals[i] * (0.6f * mean_edge_), ink, 1});
}

std::uint32_t BodyDrawing::vertex_of(const Body& body, std::uint32_t element) const {
  if (!as_particles_ && is_line())
    return element < tube_.positions().size() ? tube_.point_of(element) : element;
  if (!as_particles_) return element < creased_.source().size() ? creased_.source()[element] : element;
  if (element >= particles_.centers.size()) return element;
  // A particle has no index in the user's order: the vertex at the particle, or nearest to it, is returned.
  std::uint32_t best = 0;
  for (std::uint32_t v = 1; v < body.positions.size(); ++v)
    if (length_squared(body.positions[v] - particles_.centers[element]) <
        length_squared(body.positions[best] - particles_.centers[element]))
      best = v;
  return best;
}

}  // namespace souple::render
