#pragma once

#include "souple/math/vec3.h"

namespace souple {

/// Signed distance to a surface (negative inside) and the gradient of that distance.
struct SurfaceDistance {
  double distance = 0;  ///< m
  Vec3d normal{};       ///< unit, outward; one valid choice where it is not unique (center, axis, edge)
};

}  // namespace souple
