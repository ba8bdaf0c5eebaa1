#pragma once

#include "souple/collision/shapes.h"

#include <optional>

namespace souple {

/// First contact of a moving ball with a shape.
struct SphereCastHit {
  SurfaceDistance surface;  ///< distance and normal at `point`
  Vec3d point;              ///< center of the ball [m]
};

/// First contact of a ball of radius r with a shape, as its center moves from `from` to `to`. Sphere tracing (Hart
/// 1996): each step is as long as the free distance. Grazing paths may need many steps; a ball that is still near the
/// surface after 64 steps counts as in contact. A ball that starts in contact and moves away touches no other part of a
/// convex shape. It may touch another part of other shapes, so a smaller ball is cast there. `start`: the surface's
/// distance at `from`.
std::optional<SphereCastHit> sphere_cast(const Shape& shape, const SurfaceDistance& start, const Vec3d& from,
                                         const Vec3d& to, double r);

/// Whether a straight path may pass through a surface, from the distances at its start and end. Each distance is the
/// radius of a ball free of the shape. If the path is longer than the particle's radius r, the particle's own ball
/// counts as well.
bool may_tunnel(double start, double end, double path, double r);

}  // namespace souple
