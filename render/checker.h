#pragma once

#include "souple/geometry/triangle_mesh.h"
#include "souple/math/vec3.h"

#include <span>
#include <vector>

namespace souple::render {

/// A checker pattern attached to the material.
struct Checker {
  std::vector<Vec3f> texture;  ///< per vertex: coordinates in a solid checker of field size 1
};

/// A checker for a cloth at rest: square fields along the sides of a flat cloth, otherwise a solid checker.
/// About eight fields along the shorter side. Field borders avoid coinciding with flat parts of the surface.
Checker cloth_checker(std::span<const Vec3d> rest, std::span<const Triangle> triangles);

}  // namespace souple::render
