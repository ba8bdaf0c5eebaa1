#pragma once

#include "souple/collision/collider.h"

#include <limits>
#include <optional>
#include <span>

namespace souple {

/// Where a ray meets a surface.
struct RayHit {
  double distance = 0;  ///< along the ray [m]
  Vec3d point{};
  Vec3d normal{};  ///< unit, outward
};

/// First point of origin + s direction, 0 <= s <= max_distance, on the shape's surface, in the shape's frame.
/// The direction need not be a unit vector (distances are meters all the same); zero never hits. A ray that
/// starts inside hits at distance 0, with the normal of the nearest surface.
std::optional<RayHit> ray_cast(const Shape& shape, const Vec3d& origin, const Vec3d& direction,
                               double max_distance = std::numeric_limits<double>::infinity());

/// The same in world space, with the collider where it is at `time` [s]. A disabled collider is never hit.
std::optional<RayHit> ray_cast(const Collider& collider, double time, const Vec3d& origin,
                               const Vec3d& direction,
                               double max_distance = std::numeric_limits<double>::infinity());

/// The nearest hit among colliders, and which one; ties go to the lower index.
struct ColliderHit {
  std::size_t collider = 0;
  RayHit hit;
};
std::optional<ColliderHit> ray_cast(std::span<const Collider> colliders, double time, const Vec3d& origin,
                                    const Vec3d& direction,
                                    double max_distance = std::numeric_limits<double>::infinity());

/// The point of the shape's surface nearest to `point`, in the shape's frame.
Vec3d closest_point(const Shape& shape, const Vec3d& point);

/// Signed distance and outward normal in world space, with the collider where it is at `time` [s].
SurfaceDistance surface_distance(const Collider& collider, double time, const Vec3d& point);

}  // namespace souple
