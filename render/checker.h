#pragma once

#include "souple/geometry/triangle_mesh.h"
#include "souple/math/vec3.h"

#include <span>
#include <vector>

namespace souple::render {

/// A checker pattern that is fixed to the material and moves with it.
struct Checker {
  std::vector<Vec3f> texture;  ///< per vertex, in fields: coordinates in a solid checker of size 1
};

/// The checker of a cloth at rest: square fields along the sides of a flat cloth, else a solid checker in
/// space. About eight fields along the shorter side. Field borders avoid flat parts of the surface.
Checker cloth_checker(std::span<const Vec3d> rest, std::span<const Triangle> triangles);

}  // namespace souple::render
