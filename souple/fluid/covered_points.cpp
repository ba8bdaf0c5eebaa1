#include "souple/fluid/covered_points.h"

#include "souple/collision/mesh_tree.h"
#include "souple/error.h"
#include "souple/geometry/close_holes.h"
#include "souple/geometry/measures.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace souple {

namespace {

constexpr double crowding = 0.4;  // below it a point is too near, in spacings

/// The surface without its holes, unless one is too wide.
std::optional<TriangleMesh> solid_of(const TriangleMesh& surface, double widest_hole) {
  try {
    ClosedSurface closed = closed_surface(surface, "surface");
    for (const Hole& hole : closed.holes)
      if (hole.width > widest_hole) return {};
    return std::move(closed.mesh);
  } catch (const Error&) {
    return {};
  }
}

}  // namespace

CoveredPoints covered_points(const Shape& shape, const Transform& pose, const CoverablePoints& points) {
  CoveredPoints result;
  result.inside.reserve(points.positions.size());
  for (const Vec3d& x : points.positions) {
    const Vec3d local = rotate(conjugate(pose.rotation), x - pose.translation);
    const double distance = surface_distance(shape, local).distance;
    result.inside.push_back(distance < 0 ? 1 : 0);
    result.crowded = result.crowded || (distance >= 0 && distance < crowding * points.spacing);
  }
  return result;
}

CoveredPoints covered_points(const TriangleMesh& surface, double widest_hole, const CoverablePoints& points) {
  CoveredPoints result{std::vector<std::uint8_t>(points.positions.size()), false};
  const std::optional<TriangleMesh> solid = solid_of(surface, widest_hole);
  if (!solid) return result;
  const BoundingBox box = bounding_box(solid->positions, solid->triangles);
  const MeshTree tree(solid->positions, solid->triangles);
  std::size_t count = 0;
  bool touched = false, crowded_inside = false;  // touched: from outside
  for (std::size_t i = 0; i < points.positions.size(); ++i) {
    const Vec3d& x = points.positions[i];
    bool near = true;
    for (int k = 0; k < 3; ++k)
      near = near && x[k] > box.lo[k] - points.spacing && x[k] < box.hi[k] + points.spacing;
    if (!near) continue;
    const double distance = tree.nearest(x).distance;
    if (std::fabs(tree.winding_number(x)) > 0.5) {
      result.inside[i] = 1;
      ++count;
      crowded_inside = crowded_inside || distance < crowding * points.spacing;
    } else {
      touched = touched || distance < points.spacing;
      result.crowded = result.crowded || distance < crowding * points.spacing;
    }
  }
  if (!touched || 2 * count > points.positions.size()) {
    std::fill(result.inside.begin(), result.inside.end(), std::uint8_t{0});
    result.crowded = result.crowded || crowded_inside;
  }
  return result;
}

}  // namespace souple
