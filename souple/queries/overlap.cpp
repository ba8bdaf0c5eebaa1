#include "souple/queries/overlap.h"

#include "souple/geometry/closest_point.h"
#include "souple/geometry/measures.h"
#include "souple/queries/caches.h"
#include "souple/queries/query_search.h"
#include "souple/queries/query_view.h"

#include <algorithm>
#include <cmath>

// Which objects and colliders a shape overlaps.

namespace souple {
namespace {

/// Part of a shape's size within which it counts as touched, where the test iterates.
constexpr double touching = 1e-4;
constexpr int most_projections = 64;

struct Placed {
  const Shape& shape;
  Frame frame;

  /// In the world.
  SurfaceDistance surface(const Vec3d& p) const {
    SurfaceDistance result = surface_distance(shape, frame.to_local(p));
    result.normal = frame.pose.direction(result.normal);
    return result;
  }
};

/// An axis-aligned box around the shape in the world, infinite for planes [m].
ShapeBounds bounds_of(const Placed& placed) {
  const ShapeBounds local = shape_bounds(placed.shape);
  const Vec3d half = (local.hi - local.lo) * 0.5,
              center = placed.frame.pose.point((local.lo + local.hi) * 0.5);
  if (!is_finite(half) || !is_finite(center))
    return {{-query_infinity, -query_infinity, -query_infinity},
            {query_infinity, query_infinity, query_infinity}};
  Vec3d extent;
  for (int k = 0; k < 3; ++k) {
    Vec3d axis;
    axis[k] = half[k];
    const Vec3d turned = placed.frame.pose.direction(axis);
    for (int j = 0; j < 3; ++j) extent[j] += std::fabs(turned[j]);
  }
  return {center - extent, center + extent};
}

double size_of(const Shape& shape, double otherwise) {
  const double radius = bounding_ball(shape).radius;
  return std::isfinite(radius) ? radius : otherwise;
}

/// Whether a triangle with no corner in the shape passes through it. Alternating projections to the shape and to the
/// triangle converge to their nearest points (von Neumann), for convex shapes.
bool passes_through(const Placed& placed, const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  Vec3d p = (a + b + c) / 3.0;
  const double radius =
      std::sqrt(std::max({length_squared(a - p), length_squared(b - p), length_squared(c - p)}));
  const double near_enough = touching * size_of(placed.shape, radius);
  SurfaceDistance surface = placed.surface(p);
  if (surface.distance > radius) return false;
  for (int k = 0; k < most_projections; ++k) {
    if (surface.distance <= near_enough) return true;
    const Vec3d on = p - surface.normal * surface.distance;
    const TrianglePoint w = closest_on_triangle(on, a, b, c);
    const Vec3d next = a * w.a + b * w.b + c * w.c;
    if (length(next - p) <= 1e-3 * near_enough) return false;
    p = next;
    surface = placed.surface(p);
  }
  return false;
}

/// Calls f(vertex, true) for vertices in the shape and f(any corner, false) for triangles that pass through it, until f
/// returns false. A vertex of several triangles is passed several times.
template <class Function>
void for_each_overlap(const QueryView& view, const QueryIndex::Entry& entry, const Placed& placed,
                      const Function& f) {
  const ShapeBounds box = bounds_of(placed);
  bool goes_on = true;
  const auto bound = [&](const Bounds& b) {
    for (int k = 0; k < 3; ++k) {
      const double more = entry.radius + query_rounding * (1 + std::fabs(static_cast<double>(b.lo[k])));
      if (static_cast<double>(b.lo[k]) - more > box.hi[k] || static_cast<double>(b.hi[k]) + more < box.lo[k])
        return query_infinity;
    }
    return 0.0;
  };
  if (bound(entry.box) > 0) return;
  const auto offer = [&](std::uint32_t vertex) {
    const bool inside = placed.surface(Vec3d(entry.x[vertex])).distance <= entry.radius;
    if (inside) goes_on = f(vertex, true);
    return inside;
  };
  view.caches.query_index.tree(view, entry)
      .search(
          bound, [&] { return goes_on ? 0.0 : -1.0; },
          [&](std::uint32_t e) {
            if (!goes_on) return;
            if (entry.triangles.empty()) {
              offer(e);
              return;
            }
            bool corner = false;
            for (const std::uint32_t vertex : entry.triangles[e])
              corner = (goes_on && offer(vertex)) || corner;
            const auto& [a, b, c] = entry.triangles[e];
            if (!corner && passes_through(placed, Vec3d(entry.x[a]), Vec3d(entry.x[b]), Vec3d(entry.x[c])))
              goes_on = f(a, false);
          });
}

/// Whether two shapes have a point in common: projections to one and the other in turn.
bool shapes_overlap(const Placed& a, const Placed& b) {
  const double size = std::min(size_of(a.shape, 1), size_of(b.shape, 1));
  const Vec3d start = std::isfinite(bounding_ball(a.shape).radius)
                          ? a.frame.pose.point(bounding_ball(a.shape).center)
                          : b.frame.pose.point(bounding_ball(b.shape).center);
  Vec3d p = is_finite(start) ? start : Vec3d{};
  for (int k = 0; k < most_projections; ++k) {
    const SurfaceDistance of_a = a.surface(p);
    p -= of_a.normal * std::max(of_a.distance, 0.0);
    const SurfaceDistance of_b = b.surface(p);
    if (of_b.distance <= touching * size) return true;
    p -= of_b.normal * of_b.distance;
  }
  return false;
}

bool may_overlap(const Placed& a, const Placed& b) {
  const ShapeBounds s = bounds_of(a), t = bounds_of(b);
  for (int k = 0; k < 3; ++k)
    if (s.lo[k] > t.hi[k] || t.lo[k] > s.hi[k]) return false;
  return true;
}

}  // namespace

bool overlaps(const QueryView& view, std::size_t object, const Shape& shape, const Transform& pose) {
  const QueryIndex::Entry& entry = view.caches.query_index.entry(object);
  bool found = false;
  if (entry.x.empty()) return false;
  for_each_overlap(view, entry, {shape, {pose}}, [&](std::uint32_t, bool) { return !(found = true); });
  return found;
}

std::vector<Overlap> find_overlaps(const QueryView& view, const Shape& shape, const Transform& pose,
                                   const QueryFilter& filter) {
  const Placed placed{shape, {pose}};
  std::vector<Overlap> result;
  view.caches.query_index.refresh(view);
  for (std::size_t a = 0; a < view.objects.size(); ++a) {
    const QueryIndex::Entry& entry = view.caches.query_index.entry(a);
    if (entry.x.empty() || !passes(*entry.object, filter)) continue;
    Overlap overlap{.object = entry.object->id};
    bool found = false;
    for_each_overlap(view, entry, placed, [&](std::uint32_t vertex, bool inside) {
      if (inside) overlap.vertices.push_back(vertex);
      return found = true;
    });
    if (!found) continue;
    std::sort(overlap.vertices.begin(), overlap.vertices.end());
    overlap.vertices.erase(std::unique(overlap.vertices.begin(), overlap.vertices.end()),
                           overlap.vertices.end());
    result.push_back(std::move(overlap));
  }
  for (const ColliderRecord& record : view.colliders) {
    const Placed other{record.shape, {record.options.motion.at(view.time)}};
    if (passes(record, filter) && may_overlap(placed, other) && shapes_overlap(placed, other))
      result.push_back({.collider = record.id, .is_collider = true});
  }
  return result;
}

}  // namespace souple
