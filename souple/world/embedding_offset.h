#pragma once

#include "souple/geometry/triangle_mesh.h"

#include <vector>

namespace souple {

/// How far each point lies outside a closed surface, 0 inside and for points further than `reach` from it.
/// [m]
std::vector<float> distances_outside(const std::vector<Vec3d>& points, const TriangleMesh& surface,
                                     double max_distance);

}  // namespace souple
