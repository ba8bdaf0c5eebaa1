#pragma once

#include "souple/math/quaternion.h"

namespace souple {

/// Placement of a mesh or a collider: x -> rotation (scale x) + translation.
struct Transform {
  Vec3d translation{};
  Quatd rotation{};
  double scale = 1;

  Vec3d point(const Vec3d& x) const { return rotate(rotation, x * scale) + translation; }
  Vec3d direction(const Vec3d& x) const { return rotate(rotation, x); }
};

}  // namespace souple
