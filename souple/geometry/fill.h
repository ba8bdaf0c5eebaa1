#pragma once

#include "souple/geometry/triangle_mesh.h"
#include "souple/math/vec3.h"

#include <string>
#include <vector>

namespace souple {

/// Points `spacing` meters apart on a cubic lattice inside a box: as many as fit with half a spacing to each
/// side, centered. They stand for the box's volume to within a layer. Throws Error, starting with `name`, when
/// a number is not finite, hi is below lo, none fits or there would be more than 20 million.
std::vector<Vec3d> fill(const Vec3d& lo, const Vec3d& hi, double spacing, const std::string& name = "box");

/// The points of such a lattice over the surface's bounding box that lie inside a closed surface: where its
/// winding number is not 0, so that cavities wound inward stay hollow. Throws as above, and when the surface
/// is not closed.
std::vector<Vec3d> fill(const TriangleMesh& surface, double spacing, const std::string& name = "mesh");

}  // namespace souple
