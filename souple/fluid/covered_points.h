#pragma once

#include "souple/collision/shapes.h"
#include "souple/geometry/triangle_mesh.h"
#include "souple/math/transform.h"

#include <cstdint>
#include <span>
#include <vector>

// Points of a fluid, or centers of grains, that begin where something else is. Those of a fluid outside but within a tenth
// of a spacing count too: walls would push them away at once. So do some within about half of one: as many as the solid
// displaces there.

namespace souple {

struct CoverablePoints {
  std::span<const Vec3d> positions;
  double spacing;  ///< of a fluid, or the width of grains [m]
  bool flow;       ///< of a fluid
};

/// Per point: 1 if it lies inside a shape at a pose, else 0. Planes are walls: they cover what is behind them only.
std::vector<std::uint8_t> covered_points(const Shape& shape, const Transform& pose,
                                         const CoverablePoints& points);

/// Per point: 1 if it lies inside a surface, whose holes are closed (close_holes.h); 0 for all if that is not possible. So it
/// is if a hole is wider than `widest_hole` [m], or the surface is a vessel. A vessel contains most of the points, or no
/// point outside is within a spacing of it [m].
std::vector<std::uint8_t> covered_points(const TriangleMesh& surface, double widest_hole,
                                         const CoverablePoints& points);

}  // namespace souple
