#include "souple/contacts/collider_queries.h"

namespace souple {
namespace {

constexpr double never = std::numeric_limits<double>::infinity();

// The functions below return the distance along the unit direction `d` at which a ray from outside first hits
// a surface.

double intersect(const Plane& plane, const Vec3d& o, const Vec3d& d) {
  const double towards = dot(Vec3d(plane.normal), d);
  return towards < 0 ? (double(plane.offset) - dot(Vec3d(plane.normal), o)) / towards : never;
}

// By the point of closest approach, not by b^2 - c: no digits cancel far from the ball.
double intersect_ball(const Vec3d& o, const Vec3d& d, double radius) {
  const double ahead = -dot(o, d);
  const double half_chord_squared = radius * radius - length_squared(o + d * ahead);
  const double s = half_chord_squared >= 0 ? ahead - sqrt(half_chord_squared) : never;
  return s >= 0 ? s : never;
}

double intersect(const Sphere& sphere, const Vec3d& o, const Vec3d& d) {
  return intersect_ball(o - Vec3d(sphere.center), d, double(sphere.radius));
}

// Slab test: the ray enters the box where it enters the last slab, unless it has left another before.
double intersect(const Box& box, const Vec3d& origin, const Vec3d& d) {
  const Vec3d o = origin - Vec3d(box.center);
  double enter = -never, leave = never;
  for (int k = 0; k < 3; ++k) {
    const double half = double(box.half_extents[k]);
    if (d[k] == 0) {
      if (abs(o[k]) > half) return never;
      continue;
    }
    const double a = (-half - o[k]) / d[k], b = (half - o[k]) / d[k];
    enter = max(enter, min(a, b));
    leave = min(leave, max(a, b));
  }
  return enter <= leave && enter >= 0 ? enter : never;
}

// The side of a tube about y, between its ends.
double intersect_tube(const Vec3d& o, const Vec3d& d, double radius, double half_height) {
  const double across = sqrt(d.x * d.x + d.z * d.z);
  if (!(across > 0)) return never;
  const double s = intersect_ball({o.x, 0, o.z}, {d.x / across, 0, d.z / across}, radius) / across;
  return abs(o.y + s * d.y) <= half_height ? s : never;
}

double intersect(const Capsule& capsule, const Vec3d& origin, const Vec3d& d) {
  const Vec3d o = origin - Vec3d(capsule.center);
  const double r = double(capsule.radius), h = double(capsule.half_height);
  const double ends = min(intersect_ball(o - Vec3d{0, h, 0}, d, r), intersect_ball(o + Vec3d{0, h, 0}, d, r));
  return min(intersect_tube(o, d, r, h), ends);
}

double intersect(const Cylinder& cylinder, const Vec3d& origin, const Vec3d& d) {
  const Vec3d o = origin - Vec3d(cylinder.center);
  const double r = double(cylinder.radius), h = double(cylinder.half_height);
  double s = intersect_tube(o, d, r, h);
  if (o.y * d.y < 0 && abs(o.y) >= h) {
    const double end = (abs(o.y) - h) / abs(d.y);
    const double x = o.x + end * d.x, z = o.z + end * d.z;
    if (x * x + z * z <= r * r) s = min(s, end);
  }
  return s;
}

double intersect(const SignedDistanceField& field, const Vec3d& origin, const Vec3d& d) {
  return field.ray(origin, d);
}

}  // namespace

std::optional<RayHit> ray_cast(const Shape& shape, const Vec3d& origin, const Vec3d& direction,
                               double max_distance) {
  const double l = length(direction);
  if (!(l > 0) || !is_finite(origin) || !is_finite(direction)) return std::nullopt;
  const SurfaceDistance here = surface_distance(shape, origin);
  if (here.distance <= 0) return RayHit{0, origin, here.normal};
  const Vec3d d = direction / l;
  const double s = std::visit([&](const auto& one) { return intersect(one, origin, d); }, shape);
  if (!(s <= max_distance) || s == never) return std::nullopt;
  const Vec3d point = origin + d * s;
  return RayHit{s, point, surface_distance(shape, point).normal};
}

SurfaceDistance surface_distance(const Collider& collider, double time, const Vec3d& point) {
  const Transform pose = collider.motion.at(time);
  SurfaceDistance surface =
      surface_distance(collider.shape, rotate(conjugate(pose.rotation), point - pose.translation));
  surface.normal = pose.direction(surface.normal);
  return surface;
}

}  // namespace souple
