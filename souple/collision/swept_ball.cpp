#include "souple/collision/swept_ball.h"

#include "souple/collision/sphere_cast.h"
#include "souple/geometry/closest_point.h"

#include <algorithm>
#include <cmath>

namespace souple {
namespace {

constexpr double no_hit = std::numeric_limits<double>::infinity();

// The side of a tube of radius r around the segment from p to q, from outside.
double ray_tube(const Vec3d& o, const Vec3d& d, const Vec3d& p, const Vec3d& q, double r) {
  const Vec3d axis = q - p;
  const double height = length(axis);
  if (!(height > 0)) return no_hit;
  const Vec3d e = axis / height, s = o - p;
  const Vec3d s_across = s - e * dot(s, e), d_across = d - e * dot(d, e);
  const double speed = length(d_across);
  if (!(speed > 1e-12)) return no_hit;  // parallel: the corners stop it
  const double t = ray_ball(s_across, d_across / speed, {}, r) / speed;
  const double along = dot(s, e) + t * dot(d, e);
  return along >= 0 && along <= height ? t : no_hit;
}

// The plane of the triangle, moved by r toward o; the point of contact must be within the triangle.
double ray_face(const Vec3d& o, const Vec3d& d, double r, const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  Vec3d n = normalized(cross(b - a, c - a));
  if (dot(n, o - a) < 0) n = -n;
  const double height = dot(n, o - a), speed = -dot(n, d);
  if (!(height > r) || !(speed > 0)) return no_hit;
  const double t = (height - r) / speed;
  const Vec3d on = o + d * t - n * r;
  const TrianglePoint w = closest_on_triangle(on, a, b, c);
  // On an edge or a corner, ray_tube and ray_ball decide.
  return w.a > 0 && w.b > 0 && w.c > 0 ? t : no_hit;
}

}  // namespace

double ray_ball(const Vec3d& o, const Vec3d& d, const Vec3d& center, double radius) {
  const Vec3d s = center - o;
  const double along = dot(s, d), r2 = radius * radius;
  const double miss2 =
      length_squared(s - d * along);  // not |s|^2 - along^2: no digits cancel far from the ball
  if (miss2 > r2) return no_hit;
  const double half = std::sqrt(r2 - miss2);
  return along + half < 0 ? no_hit : std::fmax(along - half, 0.0);
}

double swept_ball(const Vec3d& o, const Vec3d& d, double r, const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const TrianglePoint w = closest_on_triangle(o, a, b, c);
  if (length_squared(a * w.a + b * w.b + c * w.c - o) <= r * r) return 0;
  double t = ray_face(o, d, r, a, b, c);
  for (const auto& [p, q] : {std::pair{a, b}, std::pair{b, c}, std::pair{c, a}})
    t = std::min({t, ray_tube(o, d, p, q, r), ray_ball(o, d, p, r)});
  return t;
}

double swept_ball(const Vec3d& o, const Vec3d& d, double r, const Shape& shape, double max_distance) {
  SurfaceDistance start = surface_distance(shape, o);
  if (start.distance <= r) return 0;
  if (std::holds_alternative<Plane>(shape)) {
    const double speed = -dot(start.normal, d);
    return speed > 0 && (start.distance - r) / speed <= max_distance ? (start.distance - r) / speed : no_hit;
  }
  if (const auto* sphere = std::get_if<Sphere>(&shape)) {
    const double t = ray_ball(o, d, Vec3d(sphere->center), static_cast<double>(sphere->radius) + r);
    return t <= max_distance ? t : no_hit;
  }
  if (const auto* capsule = std::get_if<Capsule>(&shape)) {
    const Vec3d half{0, static_cast<double>(capsule->half_height), 0}, center(capsule->center);
    const double radius = static_cast<double>(capsule->radius) + r;
    const double t = std::min({ray_ball(o, d, center - half, radius), ray_ball(o, d, center + half, radius),
                               ray_tube(o, d, center - half, center + half, radius)});
    return t <= max_distance ? t : no_hit;
  }
  const BoundingBall ball = bounding_ball(shape);
  const double path = std::min(max_distance, length(ball.center - o) + ball.radius + r);
  double gone = 0;
  for (int pass = 0; pass < 8; ++pass) {  // sphere_cast stops at 1e-4 of the distance, or after 64 strides
    const auto hit = sphere_cast(shape, start, o + d * gone, o + d * path, r);
    if (!hit) return no_hit;
    gone = dot(hit->point - o, d);
    start = hit->surface;
    if (start.distance - r <= 1e-8 * (gone + r)) break;
  }
  return gone;
}

}  // namespace souple
