#include "render/checker.h"

#include "souple/geometry/adjacency.h"
#include "souple/geometry/measures.h"
#include "souple/math/scalar.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace souple::render {
namespace {

constexpr double fields_across = 8;  ///< along the shorter side
constexpr double rim = 0.06;         ///< fraction by which a field at the rim is narrower
constexpr double flat = 1e-3;        ///< a cloth is flat if it is thinner than this fraction of its size

/// Twice the sum of the triangles' area vectors: for a flat mesh its direction is the normal.
Vec3d area_vector(std::span<const Vec3d> x, std::span<const Triangle> triangles) {
  Vec3d sum{};
  for (const Triangle& t : triangles) sum += cross(x[t[1]] - x[t[0]], x[t[2]] - x[t[0]]);
  return sum;
}

/// Range of points along a direction.
struct Extent {
  double lo = std::numeric_limits<double>::infinity(), hi = -lo;
  double size() const { return hi - lo; }
};
Extent extent_along(std::span<const Vec3d> points, const Vec3d& direction) {
  Extent result;
  for (const Vec3d& p : points) {
    const double s = dot(p, direction);
    result.lo = std::min(result.lo, s);
    result.hi = std::max(result.hi, s);
  }
  return result;
}

/// Direction, in the plane of u and v, of a side of the outline's smallest rectangle. A smallest rectangle
/// has a side along the outline (Freeman and Shapira 1975): the outline's directions are tried, one in each
/// half degree.
Vec3d side_direction(std::span<const Vec3d> rest, std::span<const Triangle> triangles, const Vec3d& u,
                     const Vec3d& v) {
  std::vector<Vec3d> outline;
  std::array<Vec3d, 180> direction{};
  std::array<bool, 180> seen{};
  for (const auto& [a, b] : boundary_edges(triangles)) {
    outline.push_back(rest[a]);
    const Vec3d edge = normalized(rest[b] - rest[a]);
    const double quarter = std::fmod(std::atan2(dot(edge, v), dot(edge, u)) + 2 * pi, pi / 2);
    const auto bin = std::min<std::size_t>(179, static_cast<std::size_t>(quarter / (pi / 360)));
    if (!seen[bin] && length_squared(edge) > 0.5) direction[bin] = edge;
    seen[bin] = true;
  }
  Vec3d best = u;
  double smallest = std::numeric_limits<double>::infinity();
  for (std::size_t bin = 0; bin < direction.size(); ++bin) {
    if (!seen[bin] || direction[bin] == Vec3d{}) continue;
    const Vec3d aside = cross(cross(u, v), direction[bin]);
    const double area = extent_along(outline, direction[bin]).size() * extent_along(outline, aside).size();
    if (area < smallest * (1 - 1e-9)) smallest = area, best = direction[bin];
  }
  return best;
}

Checker flat_checker(std::span<const Vec3d> rest, std::span<const Triangle> triangles, const Vec3d& normal) {
  const Vec3d any = normalized(cross(normal, std::abs(normal.y) < 0.9 ? Vec3d{0, 1, 0} : Vec3d{0, 0, 1}));
  const Vec3d u = side_direction(rest, triangles, any, cross(normal, any)), v = cross(normal, u);
  const Extent along_u = extent_along(rest, u), along_v = extent_along(rest, v);
  const double size = std::min(along_u.size(), along_v.size()) / fields_across;
  // A whole number of fields from side to side. They may differ a little from squares, and fields at the rim are
  // slightly narrower. Otherwise a smooth border between fields would line the cloth's edge. Across: inside a field.
  const auto scale = [size](const Extent& side) {
    return (std::max(1.0, std::round(side.size() / size)) - 2 * rim) / side.size();
  };
  const double per_u = scale(along_u), per_v = scale(along_v);
  Checker result;
  for (const Vec3d& x : rest)
    result.texture.push_back(
        Vec3f(Vec3d{rim + (dot(x, u) - along_u.lo) * per_u, 0.25, rim + (dot(x, v) - along_v.lo) * per_v}));
  return result;
}

Checker solid_checker(std::span<const Vec3d> rest, const BoundingBox& box) {
  const Vec3d size = box.size(), center = box.center();
  const double field = std::max({size.x, size.y, size.z}) / fields_across;
  // A side of the box on the border between two fields would flicker: such an axis is moved by a quarter
  // field.
  Vec3d shift{};
  for (int k = 0; k < 3; ++k) {
    const double side = size[k] / 2 / field;
    if (std::abs(side - std::round(side)) < 0.1) shift[k] = 0.25;
  }
  Checker result;
  for (const Vec3d& x : rest) result.texture.push_back(Vec3f((x - center) / field + shift));
  return result;
}

}  // namespace

Checker cloth_checker(std::span<const Vec3d> exact_rest, std::span<const Triangle> triangles) {
  // With the precision of a cache, so that the picture of a run equals that of its scene.
  std::vector<Vec3d> rest;
  rest.reserve(exact_rest.size());
  for (const Vec3d& x : exact_rest) rest.emplace_back(Vec3f(x));
  const BoundingBox box = bounding_box(rest);
  const double diagonal = box.diagonal();
  if (!(diagonal > 0)) return {std::vector<Vec3f>(rest.size(), Vec3f{0.5f, 0.5f, 0.5f})};
  const Vec3d area = area_vector(rest, triangles), normal = normalized(area);
  const bool is_flat = length(area) > 1e-9 * diagonal * diagonal &&  // not closed
                       extent_along(rest, normal).size() < flat * diagonal;
  return is_flat ? flat_checker(rest, triangles, normal) : solid_checker(rest, box);
}

}  // namespace souple::render
