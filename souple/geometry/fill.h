#pragma once

#include "souple/geometry/triangle_mesh.h"
#include "souple/math/vec3.h"

#include <string>
#include <vector>

namespace souple {

/// Points `spacing` meters apart on a cubic lattice inside a box: as many as fit with half a spacing to each
/// side, centered. Their volume matches the box's to within a layer. Throws Error, starting with `name`, if a number is
/// not finite or hi is below lo. Also throws if no point fits, or if there would be more than 20 million.
std::vector<Vec3d> fill(const Vec3d& lo, const Vec3d& hi, double spacing, const std::string& name = "box");

/// Points of such a lattice over the surface's bounding box that are inside a closed surface. Inside, the winding
/// number is not 0, so that cavities wound inward stay hollow. Throws Error as for a box, and if the surface is not
/// closed.
std::vector<Vec3d> fill(const TriangleMesh& surface, double spacing, const std::string& name = "mesh");

}  // namespace souple
