#pragma once

#include "souple/collision/shapes.h"
#include "souple/geometry/triangle_mesh.h"
#include "souple/math/transform.h"

#include <cstdint>
#include <span>
#include <vector>

// Points of a fluid that begin where something else is. Points outside but within a tenth of a spacing count too: walls
// would push them away at once.

namespace souple {

/// Per point: 1 if it lies inside a shape at a pose, else 0. Planes are walls: they cover what is behind them only.
std::vector<std::uint8_t> covered_points(const Shape& shape, const Transform& pose, double spacing,
                                         std::span<const Vec3d> points);

/// Per point: 1 if it lies inside a closed surface; 0 for all if the surface is open or a vessel. A vessel contains most of
/// the points, or no point outside is within a spacing of it [m].
std::vector<std::uint8_t> covered_points(const TriangleMesh& surface, double spacing,
                                         std::span<const Vec3d> points);

}  // namespace souple
