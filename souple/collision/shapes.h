#pragma once

#include "souple/collision/signed_distance_field.h"
#include "souple/collision/surface_distance.h"
#include "souple/math/vec3.h"

#include <string_view>
#include <variant>

// The shapes of colliders, in the collider's own frame [m]: analytic ones, and a grid of distances. Distances
// and normals are computed in double: a plane may be touched hundreds of meters from its frame's origin.

namespace souple {

/// The half-space normal . x <= offset is solid. The normal points out of it; it need not be a unit vector
/// (then `offset` scales with it), only not zero.
struct Plane {
  Vec3f normal{0, 1, 0};
  float offset = 0;  ///< m
};

struct Sphere {
  Vec3f center{};
  float radius = 0.5f;  ///< m
};

struct Box {
  Vec3f center{};
  Vec3f half_extents{0.5f, 0.5f, 0.5f};  ///< m
};

/// All points within `radius` of a segment of length 2 half_height along y.
struct Capsule {
  Vec3f center{};
  float radius = 0.25f;      ///< m
  float half_height = 0.5f;  ///< of the segment, caps not counted [m]
};

/// Axis along y, flat ends at +- half_height.
struct Cylinder {
  Vec3f center{};
  float radius = 0.25f;      ///< m
  float half_height = 0.5f;  ///< m
};

using Shape = std::variant<Plane, Sphere, Box, Capsule, Cylinder, SignedDistanceField>;

/// Whether the way between any two points of it lies in it.
bool is_convex(const Shape& shape);

/// Exact distance from a local point to the shape's surface, outside and inside (a signed distance field: see
/// there). For a finite point the result is always finite and point - normal * distance lies on the surface.
SurfaceDistance surface_distance(const Shape& shape, const Vec3d& point);

/// The center and radius of a ball that holds the shape; the radius is infinite for a plane.
struct BoundingBall {
  Vec3d center{};
  double radius = 0;
};
BoundingBall bounding_ball(const Shape& shape);

/// An axis-aligned box that holds the shape; infinite along what a plane does not bound.
struct ShapeBounds {
  Vec3d lo{}, hi{};
};
ShapeBounds shape_bounds(const Shape& shape);

/// "plane", "sphere", ...
std::string_view shape_name(const Shape& shape);

/// Throws Error when a size is not positive (a capsule's half_height may be 0), a number not finite, a
/// plane's normal zero or a signed distance field empty; `where` names the collider in the message.
void validate(const Shape& shape, std::string_view where);

}  // namespace souple
