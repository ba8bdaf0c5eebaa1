#pragma once

#include "souple/collision/shapes.h"
#include "souple/math/mat3.h"
#include "souple/math/transform.h"

#include <optional>

namespace souple {

/// Mass properties of a rigid body that replace those of its solid.
struct GivenMass {
  std::optional<double> mass{};   ///< kg; none: from the density
  std::optional<Vec3d> center{};  ///< of mass, in the frame of the mesh or shape, before its transform [m]
  /// Inertia tensor about the center of mass, in the axes of that frame [kg m^2]; none: that of the solid, for its mass.
  /// The scale of the transform does not change it.
  std::optional<Mat3d> inertia{};
};

/// A shape of a rigid body of several.
struct RigidPart {
  Shape shape;
  Transform pose{};                 ///< in the body's frame, with scale 1
  std::optional<double> density{};  ///< kg/m^3; none: the material's
};

}  // namespace souple
