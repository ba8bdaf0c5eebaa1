#include "souple/intersections/intersection_finder.h"

#include "souple/collision/segment_triangle/watertight.h"
#include "souple/math/sentinels.h"
#include "souple/state/bytes.h"

#include <algorithm>
#include <limits>

namespace souple {
namespace {

constexpr std::size_t chunk_size = 1024;
constexpr std::size_t box_grain = 1024;
constexpr float rounding = 4e-7f;  // relative to a coordinate: margin of boxes
constexpr int max_pieces = 4096;   // of a ray

Bounds around_rounded(const Vec3f& x) {
  const float margin = rounding * max(abs(x.x), max(abs(x.y), abs(x.z)));
  const Vec3f all{margin, margin, margin};
  return {x - all, x + all};
}

Bounds shifted(const Bounds& box, const Vec3f& by) {
  return {box.lo + by, box.hi + by};
}

// A box of a part of a surface, with a margin for the perturbation.
Bounds with_perturbation(const Bounds& box, const Bounds& surface) {
  const float margin = 1e-6f * length(surface.hi - surface.lo);
  return {box.lo - Vec3f{margin, margin, margin}, box.hi + Vec3f{margin, margin, margin}};
}

// In double, relative to the segment's first point. Intersections on a boundary of either do not count.
Crossing<double> crossing_of(const Vec3d& direction, const Corners<double>& corners) {
  Crossing<double> crossing = find_crossing<Watertight, double>({{}, direction}, corners);
  const Vec3d& w = crossing.weight;
  const bool within = crossing.t > 0 && crossing.t < 1 && w.x > 0 && w.y > 0 && w.z > 0;
  if (!within) crossing.t = std::numeric_limits<double>::infinity();
  return crossing;
}

Corners<double> corners_from(const ParticleView& particles, const SurfaceElement& triangle, std::uint32_t i,
                             const Vec3d& shift) {
  const auto corner = [&](std::size_t k) {
    return Vec3d(particles.difference(triangle.particle[k], i)) - shift;
  };
  return {corner(0), corner(1), corner(2)};
}

bool shares_particle(const Edge& edge, const SurfaceElement& triangle) {
  return std::any_of(std::begin(triangle.particle), std::end(triangle.particle),
                     [&](std::uint32_t i) { return i == edge[0] || i == edge[1]; });
}

}  // namespace

// --- surfaces

IntersectionFinder::IntersectionFinder(std::span<const ContactSurface> surfaces, ParticlePairs joined)
    : surfaces_(surfaces.begin(), surfaces.end()),
      any_pair_(any_may_collide(surfaces)),
      joined_(std::move(joined)) {
  const std::size_t n = surfaces.size();
  std::uint32_t end = 0;
  for (const ContactSurface& surface : surfaces) end = std::max({end, surface.end, surface.reserved_end});
  closed_.assign(n, 0);
  surface_bounds_.assign(n, empty_bounds);
  active_.assign(n, 0);
  if (!any_pair_) return;
  surface_of_.assign(end, no_index);
  for (std::uint32_t a = 0; a < n; ++a) {
    const ContactSurface& surface = surfaces[a];
    ranges_.push_back({surface.begin, surface.end});
    // A fluid may grow: its particles touch surfaces.
    std::fill(surface_of_.data() + surface.begin,
              surface_of_.data() + std::max(surface.end, surface.reserved_end), a);
    const auto first = static_cast<std::uint32_t>(elements_.triangles().size());
    elements_.add_triangles(surface.triangles, surface.begin, a);
    own_triangles_.push_back({first, static_cast<std::uint32_t>(elements_.triangles().size())});
    elements_.add_edges(surface.edges, surface.begin, a);
  }
  find_opposite();
  find_closed(surfaces);
}

void IntersectionFinder::find_opposite() {
  opposite_.assign(elements_.edges().size(), {no_index, no_index});
  for (const SurfaceElement& triangle : elements_.triangles())
    for (std::size_t k = 0; k < 3; ++k) {
      std::array<std::uint32_t, 2>& two = opposite_[triangle.edge[k]];
      const std::uint32_t corner = triangle.particle[(k + 2) % 3];
      if (two[0] == no_index) {
        two[0] = corner;
      } else if (two[1] == no_index) {
        two[1] = corner;
      }
    }
}

// Closed: every edge belongs to two triangles, which traverse it in opposite directions, and the volume is
// positive. A surface that faces inward may be a room.
void IntersectionFinder::find_closed(std::span<const ContactSurface> surfaces) {
  std::vector<Edge> sides;
  for (std::size_t a = 0; a < surfaces.size(); ++a) {
    const ContactSurface& surface = surfaces[a];
    if (surface.rest.empty()) continue;
    sides.clear();
    double volume = 0;
    for (const auto& triangle : surface.triangles) {
      for (std::size_t k = 0; k < 3; ++k) sides.push_back({triangle[k], triangle[(k + 1) % 3]});
      const Vec3d o = surface.rest[0];
      volume += dot(surface.rest[triangle[0]] - o,
                    cross(surface.rest[triangle[1]] - o, surface.rest[triangle[2]] - o));
    }
    std::sort(sides.begin(), sides.end());
    const bool once = std::adjacent_find(sides.begin(), sides.end()) == sides.end();
    const bool paired = std::all_of(sides.begin(), sides.end(), [&](const Edge& side) {
      return std::binary_search(sides.begin(), sides.end(), Edge{side[1], side[0]});
    });
    closed_[a] = volume > 0 && once && paired ? 1 : 0;
  }
}

bool IntersectionFinder::is_joined(const EdgeIntersection& pair) const {
  if (joined_.empty()) return false;
  for (std::size_t a = 0; a < 2; ++a)
    for (std::size_t b = 2; b < 5; ++b)
      if (are_joined(pair.particle[a], pair.particle[b])) return true;
  return false;
}

// --- search

// Active surfaces: with self-collision, or with bounds that overlap those of a surface they collide with.
void IntersectionFinder::find_active(const ParticleView& particles, const ObjectFilter& enabled) {
  const std::size_t n = surface_count();
  for (std::size_t a = 0; a < n; ++a) {
    surface_bounds_[a] = empty_bounds;
    for (std::uint32_t i = ranges_[a][0]; i < ranges_[a][1]; ++i)
      surface_bounds_[a] = united(surface_bounds_[a], around_rounded(particles.relative(i, {})));
    active_[a] = enabled(static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(a)) ? 1 : 0;
  }
  widened_.resize(n);
  for (std::size_t a = 0; a < n; ++a) widened_[a] = with_perturbation(surface_bounds_[a], surface_bounds_[a]);
  partners_.clear();
  for (const auto& [a, b] : sweep_.find(widened_)) {
    if (!enabled(a, b)) continue;
    partners_.push_back({a, b}), partners_.push_back({b, a});
    if (overlap(surface_bounds_[a], surface_bounds_[b])) active_[a] = active_[b] = 1;
  }
  std::sort(partners_.begin(), partners_.end());
}

// Boxes of triangles; empty for inactive surfaces.
void IntersectionFinder::find_boxes(const ParticleView& particles, Threads& threads) {
  const std::span<const SurfaceElement> triangles = elements_.triangles();
  resize_with_spare(boxes_, triangles.size());
  threads.each(triangles.size(), box_grain, [&](std::size_t t) {
    boxes_[t] = empty_bounds;
    if (active_[triangles[t].object] == 0) return;
    for (const std::uint32_t i : triangles[t].particle)
      boxes_[t] = united(boxes_[t], around_rounded(particles.relative(i, {})));
  });
}

void IntersectionFinder::find(const ParticleView& particles, Threads& threads) {
  const auto collides = [this](std::uint32_t a, std::uint32_t b) { return may_collide(surfaces_, a, b); };
  find(particles, collides, threads);
}

void IntersectionFinder::find(const ParticleView& particles, const ObjectFilter& enabled, Threads& threads) {
  found_.clear();
  if (!any_pair_) return;
  find_active(particles, enabled);
  if (std::find(active_.begin(), active_.end(), 1) == active_.end()) return;
  find_boxes(particles, threads);
  cell_size_ = SpatialHash::choose_cell_size(boxes_);
  hash_.build(boxes_, cell_size_, threads);
  const std::size_t chunks = (elements_.edges().size() + chunk_size - 1) / chunk_size;
  if (chunks_.size() < chunks) chunks_.resize(chunks);
  threads.each(chunks, 1, [&](std::size_t c) { find_chunk(particles, enabled, c); });
  for (std::size_t c = 0; c < chunks; ++c)
    found_.insert(found_.end(), chunks_[c].edges.begin(), chunks_[c].edges.end());
}

// Whether the box overlaps the bounds of a surface that `surface` collides with.
bool IntersectionFinder::may_intersect(const Bounds& box, std::uint32_t surface,
                                       const ObjectFilter& enabled) const {
  if (enabled(surface, surface)) return true;
  for (auto pair = std::lower_bound(partners_.begin(), partners_.end(), std::array{surface, 0u});
       pair != partners_.end() && (*pair)[0] == surface; ++pair)
    if (overlap(box, surface_bounds_[(*pair)[1]])) return true;
  return false;
}

void IntersectionFinder::find_chunk(const ParticleView& particles, const ObjectFilter& enabled,
                                    std::size_t c) {
  Chunk& chunk = chunks_[c];
  chunk.edges.clear();
  const std::span<const Edge> edges = elements_.edges();
  for (std::size_t e = c * chunk_size; e < std::min(edges.size(), (c + 1) * chunk_size); ++e) {
    const std::uint32_t edge_surface = elements_.edge_objects()[e];
    if (active_[edge_surface] == 0) continue;
    const Edge& edge = edges[e];
    chunk.near.clear();
    chunk.crossed_opposite.clear();
    const std::size_t before = chunk.edges.size();
    const Bounds box = box_of(particles, edge, edge_surface);
    if (!may_intersect(box, edge_surface, enabled)) continue;
    const bool itself = enabled(edge_surface, edge_surface);
    hash_.find(box, itself ? SpatialHash::Skip{} : own_triangles_[edge_surface], chunk.near);
    for (const std::uint32_t t : chunk.near) {
      const SurfaceElement& triangle = elements_.triangles()[t];
      if (!enabled(edge_surface, triangle.object) || shares_particle(edge, triangle)) continue;
      const Vec3d direction(particles.difference(edge[1], edge[0]));
      const Vec3f perturbed_by = perturbation(edge_surface, triangle.object);
      const auto crossing_at = [&](const Vec3f& shift) {
        return crossing_of(direction, corners_from(particles, triangle, edge[0], Vec3d(shift)));
      };
      const Crossing<double> at = crossing_at(perturbed_by);
      if (crossing_at(-perturbed_by).t < 1) chunk.crossed_opposite.push_back(triangle.object);
      if (!(at.t < 1)) continue;
      const auto s = static_cast<float>(at.t);
      const Vec3f w(at.weight);
      const EdgeIntersection pair{
          static_cast<std::uint32_t>(e),
          t,
          edge_surface,
          triangle.object,
          {edge[0], edge[1], triangle.particle[0], triangle.particle[1], triangle.particle[2]},
          {1 - s, s, -w.x, -w.y, -w.z}};
      if (!is_joined(pair)) chunk.edges.push_back(pair);
    }
    const auto only_touches = [&](const EdgeIntersection& pair) {
      return std::find(chunk.crossed_opposite.begin(), chunk.crossed_opposite.end(), pair.surface) ==
             chunk.crossed_opposite.end();
    };
    const auto new_ones = chunk.edges.begin() + static_cast<std::ptrdiff_t>(before);
    chunk.edges.erase(std::remove_if(new_ones, chunk.edges.end(), only_touches), chunk.edges.end());
  }
}

// Regular meshes are often aligned to the bit: edges that intersect edges, coplanar faces. So each test is
// done twice, with the surfaces perturbed in opposite directions. An edge that passes through a
// surface in only one test touches it. A surface is not perturbed against itself.
Vec3f IntersectionFinder::perturbation(std::uint32_t edge_surface, std::uint32_t surface) const {
  constexpr Vec3f generic{6.1e-7f, 3.5e-7f, 7.1e-7f};  // relative to the smaller surface's size
  if (edge_surface == surface) return {};
  const auto size = [&](std::uint32_t a) { return length(surface_bounds_[a].hi - surface_bounds_[a].lo); };
  const float smaller = min(size(edge_surface), size(surface));
  return generic * (edge_surface < surface ? smaller : -smaller);
}

// --- queries

// The ray is processed in pieces: the box of the whole ray would contain half of the surface. The direction
// is bent slightly: a ray along an axis would pass through vertices of a regular mesh, which many triangles
// share.
SurfaceHit IntersectionFinder::cast_ray(const ParticleView& particles, std::uint32_t i, const Vec3f& by,
                                        const Vec3f& straight, std::uint32_t surface, float side) const {
  const Vec3f shift = by + perturbation(surface_of_[i], surface) * side;
  constexpr Vec3f bend{7.3e-4f, -4.1e-4f, 5.9e-4f};
  const Vec3f direction = straight + bend;
  SurfaceHit hit;
  const Bounds& bounds = surface_bounds_[surface];
  const Vec3f x = particles.relative(i, {}) + shift;
  float range = 0;  // distance to the far end of the bounds along the ray
  for (int k = 0; k < 3; ++k)
    range += abs(direction[k]) * max(0.0f, direction[k] > 0 ? bounds.hi[k] - x[k] : x[k] - bounds.lo[k]);
  if (!(range > 0) || !(range < infinity)) return hit;
  range *= 1.01f;
  const int pieces = static_cast<int>(std::min(range / (2 * cell_size_), float(max_pieces - 1))) + 1;
  const Vec3d whole = Vec3d(direction) * static_cast<double>(range);
  std::vector<std::uint32_t> near;
  double first = std::numeric_limits<double>::infinity();
  for (int piece = 0; piece < pieces; ++piece) {
    const double from = double(piece) / pieces, to = double(piece + 1) / pieces;
    const Bounds box = united(around_rounded(x + Vec3f(whole * from)), around_rounded(x + Vec3f(whole * to)));
    if (!overlap(box, bounds)) continue;
    near.clear();
    hash_.find(box, near);
    for (const std::uint32_t t : near) {
      const SurfaceElement& triangle = elements_.triangles()[t];
      if (triangle.object != surface) continue;
      const Corners<double> corners = corners_from(particles, triangle, i, Vec3d(shift));
      const Crossing<double> at = find_crossing<Watertight, double>({{}, whole}, corners);
      if (!(at.t >= from && at.t < to)) continue;
      ++hit.count;
      if (at.t >= first) continue;
      first = at.t;
      hit.triangle = t;
      const Vec3f w(at.weight);
      hit.weight = {w.x, w.y, w.z};
    }
  }
  return hit;
}

bool IntersectionFinder::would_intersect(const ParticleView& particles, std::uint32_t e, const Vec3f& shift,
                                         std::uint32_t surface, const Bounds& region) const {
  const Edge& edge = elements_.edges()[e];
  const std::uint32_t edge_surface = elements_.edge_objects()[e];
  const Bounds box = shifted(box_of(particles, edge, edge_surface), shift);
  if (!overlap(box, surface_bounds_[surface]) || !overlap(box, region)) return false;
  std::vector<std::uint32_t> near;
  hash_.find(box, near);
  return std::any_of(near.begin(), near.end(), [&](std::uint32_t t) {
    const SurfaceElement& triangle = elements_.triangles()[t];
    if (triangle.object != surface || !overlap(boxes_[t], region)) return false;
    const Vec3f perturbed_by = perturbation(edge_surface, surface);
    const Vec3d direction(particles.difference(edge[1], edge[0]));
    const auto crosses = [&](const Vec3f& by) {
      return crossing_of(direction, corners_from(particles, triangle, edge[0], Vec3d(by))).t < 1;
    };
    return crosses(shift + perturbed_by) || crosses(shift - perturbed_by);
  });
}

Bounds IntersectionFinder::box_of(const ParticleView& particles, const Edge& edge,
                                  std::uint32_t edge_surface) const {
  const Bounds box = united(around_rounded(particles.relative(edge[0], {})),
                            around_rounded(particles.relative(edge[1], {})));
  return with_perturbation(box, surface_bounds_[edge_surface]);
}

std::size_t IntersectionFinder::bytes() const {
  std::size_t sum = bytes_of(joined_.sorted(), ranges_, own_triangles_, surface_of_, opposite_, closed_,
                             active_, surface_bounds_, widened_, partners_, boxes_, found_);
  for (const Chunk& chunk : chunks_) sum += bytes_of(chunk.edges, chunk.near, chunk.crossed_opposite);
  return sum + elements_.bytes() + hash_.bytes() + sweep_.bytes();
}

}  // namespace souple
