#pragma once

#include "souple/collision/signed_distance_field.h"
#include "souple/collision/surface_distance.h"
#include "souple/math/vec3.h"

#include <string_view>
#include <variant>

// Shapes of colliders, in the collider's own frame [m]: analytic shapes, and grids of signed distances.
// Distances and normals are computed in double: contacts with a plane may be hundreds of meters from its
// frame's origin.

namespace souple {

/// The solid half-space normal . x <= offset. The normal points out of the solid. It must not be zero, but
/// need not be a unit vector; `offset` scales with its length.
struct Plane {
  Vec3f normal{0, 1, 0};
  float offset = 0;  ///< along the normal [m]
};

struct Sphere {
  Vec3f center{};
  float radius = 0.5f;  ///< m
};

struct Box {
  Vec3f center{};
  Vec3f half_extents{0.5f, 0.5f, 0.5f};  ///< m
};

/// All points within `radius` of a segment along y of length 2 half_height.
struct Capsule {
  Vec3f center{};
  float radius = 0.25f;      ///< m
  float half_height = 0.5f;  ///< of the segment, without caps [m]
};

/// A cylinder with its axis along y and flat ends at +- half_height.
struct Cylinder {
  Vec3f center{};
  float radius = 0.25f;      ///< m
  float half_height = 0.5f;  ///< m
};

using Shape = std::variant<Plane, Sphere, Box, Capsule, Cylinder, SignedDistanceField>;

/// Whether the shape is convex: it contains the segment between any two of its points. False for every signed
/// distance field.
bool is_convex(const Shape& shape);

/// Exact distance from a local point to the shape's surface, outside and inside (for signed distance fields
/// see there). For a finite point the result is finite, and point - normal * distance is on the surface.
SurfaceDistance surface_distance(const Shape& shape, const Vec3d& point);

/// A ball that contains the shape. Its radius is infinite for a plane.
struct BoundingBall {
  Vec3d center{};
  double radius = 0;
};
BoundingBall bounding_ball(const Shape& shape);

/// An axis-aligned box that contains the shape [m]; infinite where a plane does not bound it.
struct ShapeBounds {
  Vec3d lo{}, hi{};
};
ShapeBounds shape_bounds(const Shape& shape);

/// "plane", "sphere", ...
std::string_view shape_name(const Shape& shape);

/// Throws Error if a size is not positive (a capsule's half_height may be 0) or a number is not finite. Also throws if
/// a plane's normal is zero or a signed distance field is empty. `where` names the collider in the message.
void validate(const Shape& shape, std::string_view where);

}  // namespace souple
