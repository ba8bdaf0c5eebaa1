#include "souple/queries/search.h"

#include "souple/collision/swept_ball.h"
#include "souple/contacts/collider_queries.h"
#include "souple/error.h"
#include "souple/geometry/closest_point.h"
#include "souple/queries/caches.h"
#include "souple/queries/query_search.h"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>

namespace souple {
namespace {

constexpr double never = query_infinity;

/// A ray with a unit direction.
struct Ray {
  Vec3d o, d, inverse;

  Ray(const Vec3d& origin, const Vec3d& direction) : o(origin), d(direction) {
    for (int k = 0; k < 3; ++k) inverse[k] = d[k] != 0 ? 1 / d[k] : 1e300;
  }
  /// Distance at which the ray enters the box, grown by `more` to all sides; never (infinity) if it misses. Slab test.
  double enter(const Bounds& box, double more) const {
    double near = 0, far = never;
    for (int k = 0; k < 3; ++k) {
      const double s = (static_cast<double>(box.lo[k]) - more - o[k]) * inverse[k];
      const double t = (static_cast<double>(box.hi[k]) + more - o[k]) * inverse[k];
      near = std::max(near, std::min(s, t));
      far = std::min(far, std::max(s, t));
    }
    return near <= far ? near : never;
  }
};

double distance_to(const Bounds& box, const Vec3d& p) {
  double sum = 0;
  for (int k = 0; k < 3; ++k) {
    const double beyond =
        std::max({static_cast<double>(box.lo[k]) - p[k], p[k] - static_cast<double>(box.hi[k]), 0.0});
    sum += beyond * beyond;
  }
  return std::sqrt(sum);
}

std::uint32_t nearest_corner(std::span<const Vec3f> x, const Triangle& triangle, const Vec3d& point) {
  std::uint32_t best = triangle[0];
  for (const std::uint32_t vertex : triangle)
    if (length_squared(Vec3d(x[vertex]) - point) < length_squared(Vec3d(x[best]) - point)) best = vertex;
  return best;
}

/// Object, then triangle or vertex: of equally distant candidates the first wins.
struct Order {
  std::uint32_t object = 0, element = 0;
  friend bool operator==(const Order&, const Order&) = default;
  friend bool operator<(const Order& a, const Order& b) {
    return a.object != b.object ? a.object < b.object : a.element < b.element;
  }
};
constexpr Order after_objects{~0u, ~0u};

/// Keeps the nearest candidate.
struct Nearest {
  Hit hit;
  double distance;
  Order order{};

  bool offer(double candidate, Order of) const {
    return candidate < distance || (candidate == distance && of < order);
  }
  void take(const Hit& better, double at, Order of) {
    hit = better;
    hit.found = true;
    hit.distance = distance = at;
    order = of;
  }
};

/// Keeps all candidates.
struct All {
  std::vector<std::pair<Hit, Order>> hits;
  double distance;

  bool offer(double candidate, Order) const { return candidate < distance; }
  void take(Hit hit, double at, Order of) {
    hit.found = true;
    hit.distance = at;
    hits.emplace_back(hit, of);
  }
  std::vector<Hit> sorted() {
    std::sort(hits.begin(), hits.end(), [](const auto& a, const auto& b) {
      if (a.first.distance != b.first.distance) return a.first.distance < b.first.distance;
      if (a.second != b.second) return a.second < b.second;
      return a.first.collider.value < b.first.collider.value;
    });
    std::vector<Hit> result;
    for (const auto& [hit, order] : hits) result.push_back(hit);
    return result;
  }
};

Corners<double> corners_of(const QueryIndex::Entry& entry, std::uint32_t t) {
  const auto& [a, b, c] = entry.triangles[t];
  return {Vec3d(entry.x[a]), Vec3d(entry.x[b]), Vec3d(entry.x[c])};
}

/// Unit normal on the side that `toward` points to.
Vec3d normal_of(const Corners<double>& f, const Vec3d& toward) {
  const Vec3d n = normalized(cross(f.b - f.a, f.c - f.a));
  return dot(n, toward) < 0 ? -n : n;
}

/// Offers all objects and colliders to `best`. A query has
///   bound(box, more): lower bound of the distance to what is within `more` of the box,
///   candidate(entry, element): the distance to an element, and complete(entry, element, distance, hit),
///   collider(record, frame, limit, hit): the same for a collider.
template <class Query, class Best>
void search(const QueryView& view, const QueryFilter& filter, const Query& query, Best& best) {
  QueryIndex& index = view.caches.query_index;
  index.refresh(view);
  const auto limit = [&] { return best.distance; };
  const auto bound_within = [&](double radius) {
    return [&query, radius](const Bounds& box) {
      return query.bound(box, radius + query_rounding * (reach(box, query.o) + radius));
    };
  };
  index.search(
      bound_within(index.largest_radius()), limit, [&](std::uint32_t object, const QueryIndex::Entry& entry) {
        if (!passes(*entry.object, filter)) return;
        index.tree(view, entry).search(bound_within(entry.radius), limit, [&](std::uint32_t element) {
          Hit hit{.object = entry.object->id};
          const double at = query.candidate(entry, element);
          if (!best.offer(at, {object, element})) return;
          query.complete(entry, element, at, hit);
          best.take(hit, at, {object, element});
        });
      });
  for (const ColliderRecord& record : view.colliders) {
    if (!passes(record, filter)) continue;
    Hit hit{.collider = record.id, .is_collider = true};
    const double at = query.collider(record, {record.options.motion.at(view.time)}, best.distance, hit);
    if (best.offer(at, after_objects)) best.take(hit, at, after_objects);
  }
}

void set_element(const QueryIndex::Entry& entry, std::uint32_t element, const Vec3d& point, Hit& hit) {
  hit.point = Vec3f(point);
  if (entry.triangles.empty()) {
    hit.vertex = element;
  } else {
    hit.triangle = element;
    hit.vertex = nearest_corner(entry.x, entry.triangles[element], point);
  }
}

struct RayQuery {
  Ray ray;
  const CrossingTest& test;
  Vec3d o = ray.o;

  double bound(const Bounds& box, double more) const { return ray.enter(box, more); }
  double candidate(const QueryIndex::Entry& entry, std::uint32_t element) const {
    if (entry.triangles.empty()) return ray_ball(ray.o, ray.d, Vec3d(entry.x[element]), entry.radius);
    return test.in_double({ray.o, ray.d, never}, corners_of(entry, element)).t;
  }
  void complete(const QueryIndex::Entry& entry, std::uint32_t element, double at, Hit& hit) const {
    const Vec3d point = ray.o + ray.d * at;
    set_element(entry, element, point, hit);
    hit.normal = Vec3f(entry.triangles.empty() ? normalized(point - Vec3d(entry.x[element]))
                                               : normal_of(corners_of(entry, element), -ray.d));
  }
  double collider(const ColliderRecord& record, const Frame& frame, double limit, Hit& hit) const {
    const auto found =
        souple::ray_cast(record.shape, frame.to_local(ray.o), frame.direction_to_local(ray.d), limit);
    if (!found) return never;
    hit.point = Vec3f(frame.pose.point(found->point));
    hit.normal = Vec3f(frame.pose.direction(found->normal));
    return found->distance;
  }
};

struct SweepQuery {
  Ray ray;
  double radius;
  Vec3d o = ray.o;

  double bound(const Bounds& box, double more) const {
    return ray.enter(box, more + radius * (1 + query_rounding));
  }
  double candidate(const QueryIndex::Entry& entry, std::uint32_t element) const {
    if (entry.triangles.empty())
      return ray_ball(ray.o, ray.d, Vec3d(entry.x[element]), radius + entry.radius);
    const Corners<double> f = corners_of(entry, element);
    return swept_ball(ray.o, ray.d, radius, f.a, f.b, f.c);
  }
  void complete(const QueryIndex::Entry& entry, std::uint32_t element, double at, Hit& hit) const {
    const Vec3d center = ray.o + ray.d * at;
    if (entry.triangles.empty()) {
      const Vec3d n = normalized(center - Vec3d(entry.x[element]));
      hit.normal = Vec3f(n);
      return set_element(entry, element, Vec3d(entry.x[element]) + n * entry.radius, hit);
    }
    const Corners<double> f = corners_of(entry, element);
    const TrianglePoint w = closest_on_triangle(center, f.a, f.b, f.c);
    const Vec3d on = f.a * w.a + f.b * w.b + f.c * w.c;
    hit.normal = Vec3f(normalized(center - on));
    set_element(entry, element, on, hit);
  }
  double collider(const ColliderRecord& record, const Frame& frame, double limit, Hit& hit) const {
    const Vec3d start = frame.to_local(ray.o), d = frame.direction_to_local(ray.d);
    const double at = swept_ball(start, d, radius, record.shape, limit);
    if (at == never) return at;
    const Vec3d center = start + d * at;
    const SurfaceDistance surface = surface_distance(record.shape, center);
    hit.point = Vec3f(frame.pose.point(center - surface.normal * surface.distance));
    hit.normal = Vec3f(frame.pose.direction(surface.normal));
    return at;
  }
};

struct PointQuery {
  Vec3d o;

  double bound(const Bounds& box, double more) const { return std::max(distance_to(box, o) - more, 0.0); }
  Vec3d nearest(const QueryIndex::Entry& entry, std::uint32_t element) const {
    if (entry.triangles.empty()) {
      const Vec3d center(entry.x[element]);
      return center + normalized(o - center) * entry.radius;
    }
    const Corners<double> f = corners_of(entry, element);
    const TrianglePoint w = closest_on_triangle(o, f.a, f.b, f.c);
    return f.a * w.a + f.b * w.b + f.c * w.c;
  }
  double candidate(const QueryIndex::Entry& entry, std::uint32_t element) const {
    return length(nearest(entry, element) - o);
  }
  void complete(const QueryIndex::Entry& entry, std::uint32_t element, double, Hit& hit) const {
    const Vec3d on = nearest(entry, element);
    set_element(entry, element, on, hit);
    hit.normal = Vec3f(entry.triangles.empty() ? normalized(on - Vec3d(entry.x[element]))
                                               : normal_of(corners_of(entry, element), o - on));
  }
  double collider(const ColliderRecord& record, const Frame& frame, double, Hit& hit) const {
    const Vec3d p = frame.to_local(o);
    const SurfaceDistance surface = surface_distance(record.shape, p);
    hit.point = Vec3f(frame.pose.point(p - surface.normal * surface.distance));
    hit.normal = Vec3f(frame.pose.direction(surface.normal));
    return std::fabs(surface.distance);
  }
};

Ray make_ray(const Vec3f& origin, const Vec3f& direction, const char* what) {
  const Vec3d o(origin), d = normalized(Vec3d(direction));
  if (!is_finite(o) || !(length_squared(d) > 0))
    throw Error(std::string(what) + ": the origin is not finite or the direction is zero");
  return {o, d};
}

}  // namespace

Hit ray_cast(const QueryView& view, const Vec3f& origin, const Vec3f& direction, double max_distance,
             const QueryFilter& filter) {
  Nearest nearest{{}, max_distance};
  search(view, filter, RayQuery{make_ray(origin, direction, "ray_cast"), view.crossing_test}, nearest);
  return nearest.hit;
}

std::vector<Hit> ray_cast_all(const QueryView& view, const Vec3f& origin, const Vec3f& direction,
                              double max_distance, const QueryFilter& filter) {
  All all{{}, max_distance};
  search(view, filter, RayQuery{make_ray(origin, direction, "ray_cast_all"), view.crossing_test}, all);
  return all.sorted();
}

Hit sphere_cast(const QueryView& view, const Vec3f& origin, float radius, const Vec3f& direction,
                double max_distance, const QueryFilter& filter) {
  if (!(radius > 0) || !std::isfinite(radius))
    throw Error(fmt::format("sphere_cast: the radius is {} m, expected a finite number above 0", radius));
  Nearest nearest{{}, max_distance};
  search(view, filter, SweepQuery{make_ray(origin, direction, "sphere_cast"), static_cast<double>(radius)},
         nearest);
  return nearest.hit;
}

Hit closest_point(const QueryView& view, const Vec3f& point, const QueryFilter& filter) {
  const Vec3d p(point);
  if (!is_finite(p)) throw Error("closest_point: the point is not finite");
  Nearest nearest{{}, never};
  search(view, filter, PointQuery{p}, nearest);
  return nearest.hit;
}

}  // namespace souple
