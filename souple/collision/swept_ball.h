#pragma once

#include "souple/collision/shapes.h"

#include <limits>

namespace souple {

/// Distance along the unit direction `d` from `o` at which a ray enters a ball: 0 if it starts inside, infinity if it
/// misses [m].
double ray_ball(const Vec3d& o, const Vec3d& d, const Vec3d& center, double radius);

/// Distance that the center of a ball of radius r moves from `o` along the unit direction `d` until the ball touches the
/// triangle: 0 if it does at the start, infinity if it never does [m]. Exact: the first contact is with the face, an edge
/// or a corner.
double swept_ball(const Vec3d& o, const Vec3d& d, double r, const Vec3d& a, const Vec3d& b, const Vec3d& c);

/// The same with a shape, in its frame; at most max_distance, which may be infinite. Exact for planes, spheres and
/// capsules; for other shapes by sphere_cast, again from where it stops until it is exact to 1e-8 of the distance.
double swept_ball(const Vec3d& o, const Vec3d& d, double r, const Shape& shape, double max_distance);

}  // namespace souple
