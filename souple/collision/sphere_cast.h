#pragma once

#include "souple/collision/shapes.h"

#include <optional>

namespace souple {

/// Where a ball is when it touches a shape.
struct SphereCastHit {
  SurfaceDistance surface;
  Vec3d point;  ///< its center [m]
};

/// Where a ball of radius r whose center goes from `from` to `to` first touches a shape: sphere tracing
/// (Hart 1996), each stride as long as the free distance. Grazing paths may need many strides; one that has
/// not passed after 64 is within a hair of the surface and counts as touching. What leaves a surface it
/// touches meets no other side of a convex shape; of any other it may, and a smaller ball goes there.
/// `start`: the surface's distance at `from`.
std::optional<SphereCastHit> sphere_cast(const Shape& shape, const SurfaceDistance& start, const Vec3d& from,
                                         const Vec3d& to, double r);

/// Whether the straight way between two points at these distances from a surface may lead through it: each
/// distance is the radius of a ball free of the shape. A particle that moves more than its radius takes the
/// ball it is itself into account as well.
bool may_tunnel(double start, double end, double path, double r);

}  // namespace souple
