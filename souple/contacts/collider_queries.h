#pragma once

#include "souple/contacts/collider.h"

#include <limits>
#include <optional>
#include <span>

namespace souple {

/// Intersection of a ray with a surface.
struct RayHit {
  double distance = 0;  ///< along the ray [m]
  Vec3d point{};
  Vec3d normal{};  ///< unit, outward
};

/// The first point of a ray on the shape's surface, up to max_distance [m], in the shape's frame. The
/// direction need not be a unit vector: distances are in meters for any length. A direction of zero length
/// never hits. A ray that starts inside hits at distance 0, with the normal of the nearest surface.
std::optional<RayHit> ray_cast(const Shape& shape, const Vec3d& origin, const Vec3d& direction,
                               double max_distance = std::numeric_limits<double>::infinity());

/// Ray cast in world space, with the collider's pose at `time` [s]. A disabled collider is never hit.
std::optional<RayHit> ray_cast(const Collider& collider, double time, const Vec3d& origin,
                               const Vec3d& direction,
                               double max_distance = std::numeric_limits<double>::infinity());

/// The nearest hit among colliders and the collider's index; the lower index wins a tie.
struct ColliderHit {
  std::size_t collider = 0;
  RayHit hit;
};
std::optional<ColliderHit> ray_cast(std::span<const Collider> colliders, double time, const Vec3d& origin,
                                    const Vec3d& direction,
                                    double max_distance = std::numeric_limits<double>::infinity());

/// The nearest point to `point` on the shape's surface, in the shape's frame.
Vec3d closest_point(const Shape& shape, const Vec3d& point);

/// Signed distance and outward normal in world space, with the collider's pose at `time` [s].
SurfaceDistance surface_distance(const Collider& collider, double time, const Vec3d& point);

}  // namespace souple
