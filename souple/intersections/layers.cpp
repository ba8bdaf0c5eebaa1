#include "souple/intersections/layers.h"

#include "souple/collision/nearest.h"
#include "souple/math/scalar.h"
#include "souple/math/sentinels.h"
#include "souple/state/bytes.h"

#include <algorithm>

namespace souple {
namespace {

constexpr float range_part = 0.05f;       // search range, relative to the lower surface's size
constexpr float coincident_part = 1e-6f;  // relative to that size: nearer points have no direction
constexpr float border_cosine = 0.7f;  // at a border: points farther from the normal are beside the surface
constexpr std::size_t layer_grain = 64;

float size_of(const Bounds& box) {
  return length(box.hi - box.lo);
}

bool are_joined(std::uint32_t vertex, const SurfaceElement& triangle, const IntersectionFinder& finder) {
  return std::any_of(std::begin(triangle.particle), std::end(triangle.particle),
                     [&](std::uint32_t i) { return finder.are_joined(vertex, i); });
}

Vec3f area_normal(const ParticleView& particles, const SurfaceElement& t) {
  return cross(particles.difference(t.particle[1], t.particle[0]),
               particles.difference(t.particle[2], t.particle[0]));
}

}  // namespace

Layers::Layers(std::span<const ContactSurface> surfaces) {
  std::vector<std::uint32_t> layered;
  for (std::uint32_t a = 0; a < surfaces.size(); ++a)
    if (surfaces[a].layer != 0) layered.push_back(a);
  for (const std::uint32_t a : layered)
    for (const std::uint32_t b : layered)
      if (surfaces[a].layer < surfaces[b].layer && !surfaces[a].triangles.empty() &&
          may_collide(surfaces, a, b))
        pairs_.push_back({a, b});
  if (pairs_.empty()) return;
  for (const Pair& pair : pairs_) ordered_.add(pair.lower, pair.upper);
  std::uint32_t end = 0;
  for (const ContactSurface& surface : surfaces) {
    surfaces_.push_back({surface.begin, surface.end, surface.layer});
    end = std::max({end, surface.end, surface.reserved_end});
  }
  has_exemption_.assign(end, 0);
}

// --- current geometry

void Layers::find_bounds(const ParticleView& particles, const ObjectPairs& enabled) {
  for (Surface& surface : surfaces_) surface.active = false;
  for (const Pair& pair : pairs_)
    if (enabled.contains(pair.lower, pair.upper))
      surfaces_[pair.lower].active = surfaces_[pair.upper].active = true;
  for (Surface& surface : surfaces_) {
    surface.bounds = empty_bounds;
    for (std::uint32_t i = surface.begin; surface.active && i < surface.end; ++i) {
      const Vec3f x = particles.relative(i, {});
      surface.bounds = united(surface.bounds, {x, x});
    }
  }
}

// Sums over triangles: of unit normals at edges; of unit normals times the angle at vertices. Not normalized.
void Layers::find_normals(const ParticleView& particles, const IntersectionFinder& finder) {
  const SurfaceElements& elements = finder.elements();
  vertex_normal_.assign(has_exemption_.size(), {});
  at_border_.assign(has_exemption_.size(), 0);
  edge_normal_.assign(elements.edges().size(), {});
  for (const SurfaceElement& t : elements.triangles()) {
    if (!surfaces_[t.object].active) continue;
    const Vec3f n = normalized(area_normal(particles, t));
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t i = t.particle[k], j = t.particle[(k + 1) % 3], l = t.particle[(k + 2) % 3];
      const Vec3f a = particles.difference(j, i), b = particles.difference(l, i);
      vertex_normal_[i] += n * atan2(length(cross(a, b)), dot(a, b));
      edge_normal_[t.edge[k]] += n;
      if (finder.opposite(t.edge[k])[1] == no_index) at_border_[i] = at_border_[j] = 1;
    }
  }
}

void Layers::build_hash(const ParticleView& particles, const IntersectionFinder& finder, Threads& threads) {
  const std::span<const SurfaceElement> triangles = finder.elements().triangles();
  resize_with_spare(boxes_, triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    boxes_[t] = empty_bounds;
    for (const std::uint32_t i : triangles[t].particle) {
      if (!surfaces_[triangles[t].object].active) continue;
      const Vec3f x = particles.relative(i, {});
      boxes_[t] = united(boxes_[t], {x, x});
    }
  }
  cell_size_ = SpatialHash::choose_cell_size(boxes_);
  hash_.build(boxes_, cell_size_, threads);
}

// --- side test

// The point nearest to x_i + shift within `range`. The search radius starts small and doubles.
Layers::Nearest Layers::nearest(const ParticleView& particles, const IntersectionFinder& finder,
                                std::uint32_t i, const Vec3f& shift, std::uint32_t surface, float range,
                                std::vector<std::uint32_t>& near) const {
  Nearest best;
  const Vec3f x = particles.relative(i, {}) + shift;
  float squared = infinity;
  for (float radius = min(0.5f * cell_size_, range);; radius = min(2 * radius, range)) {
    near.clear();
    hash_.find(widened({x, x}, radius), near);
    for (const std::uint32_t t : near) {
      const SurfaceElement& triangle = finder.elements().triangles()[t];
      if (triangle.object != surface) continue;
      Vec3f corner[3];
      for (std::size_t k = 0; k < 3; ++k) corner[k] = particles.difference(triangle.particle[k], i) - shift;
      float w[3];
      nearest_on_triangle(Vec3f{}, corner[0], corner[1], corner[2], w);
      const Vec3f offset = -(corner[0] * w[0] + corner[1] * w[1] + corner[2] * w[2]);
      const float now = length_squared(offset);
      if (!(now < squared)) continue;
      squared = now;
      best = {t, {w[0], w[1], w[2]}, offset};
    }
    if (squared <= radius * radius || radius >= range) break;
  }
  return squared <= range * range ? best : Nearest{};
}

// Zero weights show whether the point lies on an edge or a corner of the triangle.
Vec3f Layers::normal_at(const Nearest& nearest, const ParticleView& particles,
                        const IntersectionFinder& finder, bool& border) const {
  const SurfaceElement& t = finder.elements().triangles()[nearest.triangle];
  std::size_t zeros = 0, zero = 0, other = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    if (nearest.weight[k] > 0) {
      other = k;
    } else {
      ++zeros, zero = k;
    }
  }
  border = false;
  if (zeros == 0) return normalized(area_normal(particles, t));
  if (zeros == 1) {
    const std::uint32_t edge = t.edge[(zero + 1) % 3];
    border = finder.opposite(edge)[1] == no_index;
    return normalized(edge_normal_[edge]);
  }
  border = at_border_[t.particle[other]] != 0;
  return normalized(vertex_normal_[t.particle[other]]);
}

// A point in the surface counts as under it, because its contact would have no side.
bool Layers::is_under(const Nearest& nearest, const ParticleView& particles, const IntersectionFinder& finder,
                      float size, Vec3f& normal) const {
  if (nearest.triangle == no_index) return false;
  bool border = false;
  normal = normal_at(nearest, particles, finder, border);
  if (!(length_squared(normal) > 0)) return false;
  const float height = dot(normal, nearest.offset), distance = length(nearest.offset);
  if (distance <= coincident_part * size) return true;
  return border ? height < -border_cosine * distance : height < 0;
}

float Layers::search_range(const Pair& pair) const {
  return range_part * size_of(surfaces_[pair.lower].bounds);
}

// --- violations

bool Layers::test_upper(const Pair& pair, std::uint32_t i, const ParticleView& particles,
                        const IntersectionFinder& finder, std::vector<std::uint32_t>& near,
                        LayerViolation& found) const {
  const Bounds& bounds = surfaces_[pair.lower].bounds;
  const float size = size_of(bounds);
  const Vec3f x = particles.relative(i, {});
  const bool may_be_inside = finder.is_closed(pair.lower) && overlap(bounds, {x, x});
  const float range = may_be_inside ? size : search_range(pair);
  if (!overlap(widened(bounds, range), {x, x})) return false;
  const Nearest on = nearest(particles, finder, i, {}, pair.lower, range, near);
  Vec3f normal;
  if (!is_under(on, particles, finder, size, normal)) return false;
  if (are_joined(i, finder.elements().triangles()[on.triangle], finder)) return false;
  const float depth = length(on.offset);
  const auto& corner = finder.elements().triangles()[on.triangle].particle;
  found = {i,
           pair.lower,
           {i, corner[0], corner[1], corner[2]},
           {1, -on.weight[0], -on.weight[1], -on.weight[2]},
           depth > coincident_part * size ? -on.offset / depth : normal,
           depth};
  return true;
}

// Tests the point of the upper surface that is nearest to vertex i of the lower one.
bool Layers::test_lower(const Pair& pair, std::uint32_t i, const ParticleView& particles,
                        const IntersectionFinder& finder, std::vector<std::uint32_t>& near,
                        LayerViolation& found) const {
  const float size = size_of(surfaces_[pair.lower].bounds), range = search_range(pair);
  const Vec3f x = particles.relative(i, {});
  if (!overlap(widened(surfaces_[pair.upper].bounds, range), {x, x})) return false;
  const Nearest above = nearest(particles, finder, i, {}, pair.upper, range, near);
  if (above.triangle == no_index || are_joined(i, finder.elements().triangles()[above.triangle], finder))
    return false;
  const Nearest on = nearest(particles, finder, i, -above.offset, pair.lower, range, near);
  Vec3f normal;
  if (!is_under(on, particles, finder, size, normal)) return false;
  const float depth = length(above.offset);
  const Vec3f direction = depth > coincident_part * size ? above.offset / depth : normal;
  if (!(dot(direction, normal) > 0)) return false;  // the surface is folded between the two points
  const auto& corner = finder.elements().triangles()[above.triangle].particle;
  found = {i,
           pair.upper,
           {i, corner[0], corner[1], corner[2]},
           {-1, above.weight[0], above.weight[1], above.weight[2]},
           direction,
           depth};
  return true;
}

void Layers::find_pair(const Pair& pair, const ParticleView& particles, const IntersectionFinder& finder,
                       Threads& threads) {
  const SurfaceElements& elements = finder.elements();
  violation_of_.resize(elements.vertices().size());
  is_violation_.assign(violation_of_.size(), 0);
  threads.for_each(violation_of_.size(), layer_grain, [&](std::size_t v, std::size_t end) {
    std::vector<std::uint32_t> near;
    for (; v < end; ++v) {
      const std::uint32_t i = elements.vertices()[v], surface = elements.vertex_objects()[v];
      const bool violates =
          (surface == pair.upper && test_upper(pair, i, particles, finder, near, violation_of_[v])) ||
          (surface == pair.lower && test_lower(pair, i, particles, finder, near, violation_of_[v]));
      is_violation_[v] = violates ? 1 : 0;
    }
  });
  for (std::size_t v = 0; v < violation_of_.size(); ++v)
    if (is_violation_[v] != 0) found_.push_back(violation_of_[v]);
}

void Layers::find(const ParticleView& particles, const IntersectionFinder& finder, const ObjectPairs& enabled,
                  Threads& threads) {
  for (const LayerViolation& violation : found_) has_exemption_[violation.vertex] = 0;
  found_.clear();
  exemptions_.clear();
  if (!any()) return;
  find_bounds(particles, enabled);
  if (std::none_of(surfaces_.begin(), surfaces_.end(), [](const Surface& s) { return s.active; })) return;
  find_normals(particles, finder);
  build_hash(particles, finder, threads);
  for (const Pair& pair : pairs_) {
    if (!enabled.contains(pair.lower, pair.upper)) continue;
    if (overlap(widened(surfaces_[pair.lower].bounds, search_range(pair)), surfaces_[pair.upper].bounds))
      find_pair(pair, particles, finder, threads);
  }
  for (const LayerViolation& violation : found_) {
    has_exemption_[violation.vertex] = 1;
    exemptions_.push_back({violation.vertex, violation.surface});
  }
  std::sort(exemptions_.begin(), exemptions_.end());
}

bool Layers::is_exempt(std::uint32_t vertex, std::uint32_t surface) const {
  return !exemptions_.empty() && has_exemption_[vertex] != 0 &&
         std::binary_search(exemptions_.begin(), exemptions_.end(),
                            std::array<std::uint32_t, 2>{vertex, surface});
}

Vec3f Layers::outward(const EdgeIntersection& intersection, const ParticleView& particles,
                      const IntersectionFinder& finder) const {
  if (surfaces_[intersection.surface].layer < surfaces_[intersection.edge_surface].layer)
    return normalized(area_normal(particles, finder.elements().triangles()[intersection.triangle]));
  return -normalized(edge_normal_[intersection.edge]);
}

std::size_t Layers::bytes() const {
  return hash_.bytes() + bytes_of(surfaces_, pairs_, vertex_normal_, edge_normal_, at_border_, boxes_,
                                  violation_of_, is_violation_, has_exemption_, exemptions_, found_);
}

}  // namespace souple
