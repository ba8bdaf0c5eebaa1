#include "souple/collision/shapes.h"

#include "souple/error.h"
#include "souple/math/limits.h"

#include <limits>
#include <string>

#include <fmt/core.h>

namespace souple {
namespace {

// Below this length a vector's direction is rounding noise of underflow.
constexpr double no_length = 1e-150;

double sign_of(double a) {
  return a < 0 ? -1.0 : 1.0;
}

SurfaceDistance from_point(const Vec3d& offset, double radius, const Vec3d& fallback) {
  const double l = length(offset);
  return {l - radius, l > no_length ? offset / l : fallback};
}

SurfaceDistance distance_to(const Plane& plane, const Vec3d& point) {
  const Vec3d n(plane.normal);
  const double l = length(n);
  return {(dot(n, point) - double(plane.offset)) / l, n / l};
}

SurfaceDistance distance_to(const Sphere& sphere, const Vec3d& point) {
  return from_point(point - Vec3d(sphere.center), double(sphere.radius), {0, 1, 0});
}

// Outside: the vector beyond the faces. Inside: the nearest face.
SurfaceDistance distance_to(const Box& box, const Vec3d& point) {
  const Vec3d p = point - Vec3d(box.center);
  Vec3d beyond, outward;
  int nearest = 0;
  double depth[3];
  for (int k = 0; k < 3; ++k) {
    depth[k] = abs(p[k]) - double(box.half_extents[k]);
    beyond[k] = max(depth[k], 0.0);
    outward[k] = beyond[k] * sign_of(p[k]);
    if (depth[k] > depth[nearest]) nearest = k;
  }
  const double l = length(beyond);
  if (l > no_length) return {l, outward / l};
  Vec3d normal;
  normal[nearest] = sign_of(p[nearest]);
  return {depth[nearest], normal};
}

SurfaceDistance distance_to(const Capsule& capsule, const Vec3d& point) {
  const Vec3d p = point - Vec3d(capsule.center);
  const double h = double(capsule.half_height);
  return from_point({p.x, p.y - max(-h, min(h, p.y)), p.z}, double(capsule.radius), {1, 0, 0});
}

SurfaceDistance distance_to(const Cylinder& cylinder, const Vec3d& point) {
  const Vec3d p = point - Vec3d(cylinder.center);
  const double from_axis = sqrt(p.x * p.x + p.z * p.z);
  const Vec3d radial = from_axis > no_length ? Vec3d{p.x / from_axis, 0, p.z / from_axis} : Vec3d{1, 0, 0};
  const Vec3d axial{0, sign_of(p.y), 0};
  const double side = from_axis - double(cylinder.radius);
  const double end = abs(p.y) - double(cylinder.half_height);
  const Vec3d beyond = radial * max(side, 0.0) + axial * max(end, 0.0);
  const double l = length(beyond);
  if (l > no_length) return {l, beyond / l};
  return side > end ? SurfaceDistance{side, radial} : SurfaceDistance{end, axial};
}

SurfaceDistance distance_to(const SignedDistanceField& field, const Vec3d& point) {
  return field.at(point);
}

struct Validator {
  std::string where;

  void size(const char* what, float value, bool zero_allowed = false) const {
    if (std::isfinite(value) && (value > 0 || (zero_allowed && value == 0))) return;
    throw Error(fmt::format("{}: {} is {:g}; expected a finite length {}, in meters", where, what, value,
                            zero_allowed ? "of at least 0" : "above 0"));
  }
  void point(const char* what, const Vec3f& value) const {
    if (is_within(value, range::coordinate)) return;
    throw Error(fmt::format("{}: {} is ({:g}, {:g}, {:g}); expected finite numbers of at most {:g}", where,
                            what, value.x, value.y, value.z, range::coordinate));
  }

  void operator()(const Plane& plane) const {
    point("plane normal", plane.normal);
    if (!(length(Vec3d(plane.normal)) > 0))
      throw Error(where + ": plane normal is (0, 0, 0); expected the direction out of the solid");
    if (!std::isfinite(plane.offset))
      throw Error(fmt::format("{}: plane offset is {:g}; expected a finite number", where, plane.offset));
  }
  void operator()(const Sphere& sphere) const {
    point("sphere center", sphere.center);
    size("sphere radius", sphere.radius);
  }
  void operator()(const Box& box) const {
    point("box center", box.center);
    size("box half_extents x", box.half_extents.x);
    size("box half_extents y", box.half_extents.y);
    size("box half_extents z", box.half_extents.z);
  }
  void operator()(const Capsule& capsule) const {
    point("capsule center", capsule.center);
    size("capsule radius", capsule.radius);
    size("capsule half_height", capsule.half_height, true);
  }
  void operator()(const Cylinder& cylinder) const {
    point("cylinder center", cylinder.center);
    size("cylinder radius", cylinder.radius);
    size("cylinder half_height", cylinder.half_height);
  }
  void operator()(const SignedDistanceField& field) const {
    if (field.empty())
      throw Error(where + ": the signed distance field is empty; expected one made from a closed mesh");
  }
};

// A plane whose normal is along an axis bounds the box on one side; any other plane bounds nothing.
ShapeBounds box_of(const Plane& plane) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  ShapeBounds box{{-infinity, -infinity, -infinity}, {infinity, infinity, infinity}};
  for (int k = 0; k < 3; ++k) {
    const double n = double(plane.normal[k]);
    if (n == 0 || double(plane.normal[(k + 1) % 3]) != 0 || double(plane.normal[(k + 2) % 3]) != 0) continue;
    (n > 0 ? box.hi : box.lo)[k] = double(plane.offset) / n;
  }
  return box;
}

ShapeBounds box_about(const Vec3f& center, double x, double y, double z) {
  const Vec3d c(center), half{x, y, z};
  return {c - half, c + half};
}
ShapeBounds box_of(const Sphere& s) {
  return box_about(s.center, double(s.radius), double(s.radius), double(s.radius));
}
ShapeBounds box_of(const Box& b) {
  return box_about(b.center, double(b.half_extents.x), double(b.half_extents.y), double(b.half_extents.z));
}
ShapeBounds box_of(const Capsule& c) {
  return box_about(c.center, double(c.radius), double(c.half_height) + double(c.radius), double(c.radius));
}
ShapeBounds box_of(const Cylinder& c) {
  return box_about(c.center, double(c.radius), double(c.half_height), double(c.radius));
}
ShapeBounds box_of(const SignedDistanceField& field) {
  return {field.lo(), field.hi()};
}

BoundingBall ball_of(const Plane&) {
  return {{}, std::numeric_limits<double>::infinity()};
}
BoundingBall ball_of(const Sphere& s) {
  return {Vec3d(s.center), double(s.radius)};
}
BoundingBall ball_of(const Box& b) {
  return {Vec3d(b.center), length(Vec3d(b.half_extents))};
}
BoundingBall ball_of(const Capsule& c) {
  return {Vec3d(c.center), double(c.half_height) + double(c.radius)};
}
BoundingBall ball_of(const Cylinder& c) {
  return {Vec3d(c.center), length(Vec3d{double(c.radius), double(c.half_height), 0})};
}
BoundingBall ball_of(const SignedDistanceField& field) {
  return {(field.lo() + field.hi()) * 0.5, 0.5 * length(field.hi() - field.lo())};
}

}  // namespace

bool is_convex(const Shape& shape) {
  return !std::holds_alternative<SignedDistanceField>(shape);
}

SurfaceDistance surface_distance(const Shape& shape, const Vec3d& point) {
  return std::visit([&](const auto& s) { return distance_to(s, point); }, shape);
}

BoundingBall bounding_ball(const Shape& shape) {
  return std::visit([](const auto& s) { return ball_of(s); }, shape);
}

ShapeBounds shape_bounds(const Shape& shape) {
  return std::visit([](const auto& s) { return box_of(s); }, shape);
}

std::string_view shape_name(const Shape& shape) {
  constexpr std::string_view names[] = {"plane",   "sphere",   "box",
                                        "capsule", "cylinder", "signed_distance_field"};
  return names[shape.index()];
}

void validate(const Shape& shape, std::string_view where) {
  std::visit(Validator{std::string(where)}, shape);
}

}  // namespace souple
