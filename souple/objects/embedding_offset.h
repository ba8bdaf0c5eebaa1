#pragma once

#include "souple/geometry/triangle_mesh.h"

#include <vector>

namespace souple {

/// Distance of each point outside a closed surface [m]; 0 inside and beyond `max_distance`.
std::vector<float> distances_outside(const std::vector<Vec3d>& points, const TriangleMesh& surface,
                                     double max_distance);

}  // namespace souple
