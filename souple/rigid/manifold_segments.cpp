#include "souple/collision/nearest.h"
#include "souple/rigid/manifold_pair.h"

#include <algorithm>
#include <cmath>

// Spheres and capsules.

namespace souple::manifold {
namespace {

/// Some unit vector perpendicular to d, or along x where d is zero.
Vec3d perpendicular_to(const Vec3d& d) {
  const bool along_x = std::abs(d.x) > std::abs(d.y);
  const Vec3d n = cross(d, along_x ? Vec3d{0, 1, 0} : Vec3d{1, 0, 0});
  return length_squared(n) > 0 ? normalized(n) : Vec3d{1, 0, 0};
}

/// From a to b where the cores touch: across both segments, toward the other center.
Vec3d axis_of_touching(const ShapePair& pair, const Segment& a, const Segment& b) {
  const Vec3d centers = pair.b_to_a.point(pair.b.center) - pair.a.center;
  Vec3d n = cross(a.along(), b.along());
  constexpr double least_sine = 1e-6;
  if (length_squared(n) <= least_sine * least_sine * length_squared(a.along()) * length_squared(b.along())) {
    const Vec3d d = length_squared(a.along()) > length_squared(b.along()) ? a.along() : b.along();
    const double squared = length_squared(d);
    n = squared > 0 ? centers - d * (dot(centers, d) / squared) : centers;
    if (!(length_squared(n) > 1e-24 * length_squared(centers))) n = perpendicular_to(d);
  }
  return dot(n, centers) < 0 ? -normalized(n) : normalized(n);
}

/// The interval of a segment a that lies beside the nearly parallel segment b, as parameters of a; none if it is short.
bool common_interval(const Segment& a, const Segment& b, double (&interval)[2]) {
  const Vec3d d = a.along(), e = b.along();
  const double squared = length_squared(d);
  constexpr double least_sine = 0.01, least_length = 1e-3;
  if (!(squared > 0) || !(length_squared(e) > 0)) return false;
  if (length_squared(cross(d, e)) > least_sine * least_sine * squared * length_squared(e)) return false;
  const double s = dot(b.from - a.from, d) / squared, t = dot(b.to - a.from, d) / squared;
  interval[0] = std::max(0.0, std::min(s, t)), interval[1] = std::min(1.0, std::max(s, t));
  return interval[1] - interval[0] > least_length;
}

}  // namespace

bool add_parallel_segments(const ShapePair& pair, const Segment& a, const Segment& b, const Vec3d& axis,
                           std::uint32_t feature, Manifold& manifold) {
  double interval[2];
  if (!common_interval(a, b, interval)) return false;
  for (std::uint32_t k = 0; k < 2; ++k) {
    const Vec3d on_a = a.at(interval[k]), on_b = b.at(nearest_on_edge(on_a, b.from, b.to));
    if (dot(on_b - on_a, axis) < pair.limit()) add_point(pair, on_a, on_b, axis, feature ^ k, manifold);
  }
  return manifold.count > 0;
}

void find_segment_points(const ShapePair& pair, Manifold& manifold) {
  const Segment a{pair.a.vertices.front(), pair.a.vertices.back()};
  const Segment b{pair.b_to_a.point(pair.b.vertices.front()), pair.b_to_a.point(pair.b.vertices.back())};
  double s = 0, t = 0;
  nearest_on_edges(a.from, a.to, b.from, b.to, s, t);
  const Vec3d between = b.at(t) - a.at(s);
  const double distance = length(between);
  if (distance >= pair.limit()) return;
  constexpr double touching = 1e-9;
  const bool apart = distance > touching * pair.rounding();
  const Vec3d axis = apart ? between / distance : axis_of_touching(pair, a, b);
  if (add_parallel_segments(pair, a, b, axis, feature_id(FeatureKind::other, 0, 0), manifold)) return;
  add_point(pair, a.at(s), b.at(t), axis, feature_id(FeatureKind::edges, 0, 0), manifold);
}

}  // namespace souple::manifold
