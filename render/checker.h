#pragma once

#include "souple/geometry/triangle_mesh.h"
#include "souple/math/vec3.h"

#include <span>
#include <vector>

namespace souple::render {

/// A pattern of fields that is fixed to the material and moves with it.
struct Checker {
  std::vector<Vec3f> texture;  ///< per vertex, in fields: a solid checker of size 1 at these points
};

/// For a cloth at rest: a flat one gets square fields along its sides, any other a checker in space. About
/// eight fields along the shorter side. Field borders keep away from flat parts of the surface.
Checker cloth_checker(std::span<const Vec3d> rest, std::span<const Triangle> triangles);

}  // namespace souple::render
