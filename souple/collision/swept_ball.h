#pragma once

#include "souple/collision/shapes.h"

#include <limits>

namespace souple {

/// Distance along the unit direction `d` from `o` at which a ray enters a ball: 0 if it starts inside, infinity if it
/// misses [m].
double ray_ball(const Vec3d& o, const Vec3d& d, const Vec3d& center, double radius);

/// Distance that the center of a ball of radius r moves from `o` along the unit direction `d` until the ball touches
/// the triangle [m]. It is 0 if the ball touches at the start, infinity if it never does. Exact: the first contact is
/// with the face, an edge or a corner.
double swept_ball(const Vec3d& o, const Vec3d& d, double r, const Vec3d& a, const Vec3d& b, const Vec3d& c);

/// Likewise for a shape, in its frame; at most max_distance, which may be infinite. Exact for planes, spheres and
/// capsules. For other shapes sphere_cast is repeated from where it stops, until the distance is exact to 1e-8 of
/// itself.
double swept_ball(const Vec3d& o, const Vec3d& d, double r, const Shape& shape, double max_distance);

}  // namespace souple
