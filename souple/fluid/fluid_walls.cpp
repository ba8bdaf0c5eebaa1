#include "souple/fluid/fluid_walls.h"

#include "souple/collision/sphere_cast.h"

#include <limits>

namespace souple {

void FluidWalls::begin_step(std::span<const Collider> colliders, std::span<const std::uint8_t> collides,
                            const Vec3d& origin, std::size_t particles, double time) {
  colliders_ = colliders, collides_ = collides, origin_ = origin;
  clearances_.assign(particles, {});
  static_walls_.clear();
  moving_walls_.clear();
  for (std::uint32_t c = 0; c < colliders.size(); ++c) {
    if (!colliders[c].enabled) continue;
    Wall wall;
    wall.collider = c;
    wall.moves = !colliders[c].motion.is_static();
    wall.ball = bounding_ball(colliders[c].shape);
    wall.before = wall.after = pose_at(colliders[c].motion, time);
    wall.center = wall.after.to_world(wall.ball.center);
    if (const auto* plane = std::get_if<Plane>(&colliders[c].shape); plane && !wall.moves) {
      const double size = length(Vec3d(plane->normal));
      wall.is_plane = true;
      wall.normal = wall.after.rotation * Vec3d(plane->normal) / size;
      wall.offset = double{plane->offset} / size + dot(wall.normal, wall.after.translation - origin);
    }
    (wall.moves ? moving_walls_ : static_walls_).push_back(wall);
  }
}

void FluidWalls::begin_substep(double time, double h) {
  for (Wall& wall : moving_walls_) {
    const auto [before, after] = poses_between(colliders_[wall.collider].motion, time, time + h);
    wall.before = before, wall.after = after;
    wall.center = after.to_world(wall.ball.center);
  }
}

double FluidWalls::add_plane(const Wall& wall, std::size_t fluid, const Vec3f& x, float search_radius,
                             std::vector<BoundaryPlane>& planes) const {
  if (!collides_with(wall, fluid)) return std::numeric_limits<double>::infinity();
  const double clear = distance_bound(wall, Vec3d(x));
  if (clear > double{search_radius}) return clear;
  const Vec3d world = origin_ + Vec3d(x);
  const SurfaceDistance surface =
      surface_distance(colliders_[wall.collider].shape, wall.after.to_local(world));
  if (surface.distance > double{search_radius}) return surface.distance;
  const Vec3f normal(wall.after.rotation * surface.normal);
  Vec3f motion{};
  if (wall.moves) {
    const Vec3d point = wall.after.to_local(world) - surface.normal * surface.distance;
    motion = Vec3f(wall.after.to_world(point) - wall.before.to_world(point));
  }
  planes.push_back({.normal = normal,
                    .offset = dot(normal, x) - static_cast<float>(surface.distance),
                    .motion = motion,
                    .collider = wall.collider});
  return surface.distance;
}

// Computed in the wall's frame, where the wall is static. A particle that touches the wall on its path slides
// along the plane of the contact.
Vec3d FluidWalls::stopped_by(const Wall& wall, const Vec3d& start, const Vec3d& x, double radius) const {
  if (length(x - wall.center) - wall.ball.radius >
      radius + length(x - start) + length(wall.after.translation - wall.before.translation))
    return x;
  const Shape& shape = colliders_[wall.collider].shape;
  const Vec3d from = wall.before.to_local(start), to = wall.after.to_local(x);
  SurfaceDistance end = surface_distance(shape, to);
  const double path = length(to - from);
  if (end.distance > max(radius, path)) return x;
  const SurfaceDistance begin = surface_distance(shape, from);
  if (begin.distance > 0 && may_tunnel(begin.distance, end.distance, path, radius)) {
    if (const auto hit = sphere_cast(shape, begin, from, to, radius))
      end = {dot(hit->surface.normal, to - hit->point) + hit->surface.distance, hit->surface.normal};
  }
  if (!(end.distance < radius)) return x;
  return wall.after.to_world(to + end.normal * (radius - end.distance));
}

// If both ends of the path lie in a ball free of static walls, so does the path.
Vec3f FluidWalls::keep_out(std::size_t i, std::size_t fluid, const Vec3f& start, const Vec3f& x,
                           float radius) const {
  const Clearance& clearance = clearances_[i];
  const bool clear = max(length(x - clearance.at), length(start - clearance.at)) + radius < clearance.clear;
  return keep_out(fluid, start, x, radius, clear);
}

Vec3f FluidWalls::keep_out(std::size_t fluid, const Vec3f& start, const Vec3f& x, float radius) const {
  return keep_out(fluid, start, x, radius, false);
}

// `clear`: no static wall is near the path.
Vec3f FluidWalls::keep_out(std::size_t fluid, const Vec3f& start, const Vec3f& x, float radius,
                           bool clear) const {
  if (clear && moving_walls_.empty()) return x;
  const Vec3d before = origin_ + Vec3d(start), predicted = origin_ + Vec3d(x);
  Vec3d at = predicted;
  if (!clear) {
    // A wall further from the path's end than the path's length cannot touch the path.
    double range = double{radius} + length(at - before);
    for (const Wall& wall : static_walls_) {
      if (!collides_with(wall, fluid) || distance_bound(wall, at - origin_) > range) continue;
      at = stopped_by(wall, before, at, double{radius});
      range = double{radius} + length(at - before);
    }
  }
  for (const Wall& wall : moving_walls_)
    if (collides_with(wall, fluid)) at = stopped_by(wall, before, at, double{radius});
  return at == predicted ? x : Vec3f(at - origin_);
}

void FluidWalls::find(std::size_t i, std::size_t fluid, const Vec3f& x, float search_radius,
                      std::vector<BoundaryPlane>& planes) {
  Clearance& clearance = clearances_[i];
  if (!(length(x - clearance.at) + search_radius < clearance.clear)) {
    double clear = std::numeric_limits<double>::infinity();
    for (const Wall& wall : static_walls_)
      clear = min(clear, add_plane(wall, fluid, x, search_radius, planes));
    clearance = {x, static_cast<float>(min(clear, 1e30))};
  }
  for (const Wall& wall : moving_walls_) add_plane(wall, fluid, x, search_radius, planes);
}

}  // namespace souple
