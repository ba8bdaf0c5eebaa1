#pragma once

#include "souple/collision/shapes.h"
#include "souple/geometry/triangle_mesh.h"
#include "souple/math/transform.h"

#include <cstdint>
#include <span>
#include <vector>

// Points of a fluid, or centers of grains, that begin where something else is.

namespace souple {

struct CoverablePoints {
  std::span<const Vec3d> positions;
  double spacing;  ///< of a fluid, or the width of grains [m]
};

struct CoveredPoints {
  std::vector<std::uint8_t> inside;  ///< per point: 1 if it lies inside, else 0
  /// Whether a point outside is nearer than 0.4 spacings. Fluid at a wall begins half a spacing from it.
  bool crowded = false;
};

/// For a shape at a pose.
CoveredPoints covered_points(const Shape& shape, const Transform& pose, const CoverablePoints& points);

/// For a surface, whose holes are closed (close_holes.h). No point is inside if that is not possible. So it is if a hole is
/// wider than `widest_hole` [m], or the surface is a vessel. A vessel contains most of the points, or no point outside is
/// within a spacing of it [m].
CoveredPoints covered_points(const TriangleMesh& surface, double widest_hole, const CoverablePoints& points);

}  // namespace souple
