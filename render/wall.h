#pragma once

#include "souple/geometry/triangle_mesh.h"
#include "souple/math/vec3.h"

#include <span>

namespace souple::render {

/// Glass that a ray crosses at a surface.
struct Wall {
  bool closed = false;  ///< a solid: every edge belongs to two triangles; otherwise a thin sheet
  float thickness = 1;  ///< of a solid, mean: twice its volume over its area, exact for a plate [m]
};
/// Triangles with indices outside `positions` make a sheet.
Wall wall_of(std::span<const Vec3f> positions, std::span<const Triangle> triangles);

}  // namespace souple::render
