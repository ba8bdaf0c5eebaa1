#pragma once

#include "souple/math/vec3.h"

namespace souple {

/// Signed distance to a surface (negative inside) and its gradient there.
struct SurfaceDistance {
  double distance = 0;  ///< m
  Vec3d normal{};  ///< unit, outward; where it is not unique (a center, an axis, an edge), one valid choice
};

}  // namespace souple
