#pragma once

#include "souple/contacts/collider.h"

#include <limits>
#include <optional>

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

/// Signed distance and outward normal in world space, with the collider's pose at `time` [s].
SurfaceDistance surface_distance(const Collider& collider, double time, const Vec3d& point);

}  // namespace souple
