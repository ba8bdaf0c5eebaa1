#pragma once

#include "souple/rigid/rigid_shape.h"
#include "souple/state/rigid_bodies.h"

#include <vector>

namespace souple {

/// Definition of a rigid body besides its Object. Its local frame has its origin at the center of mass and principal
/// axes.
struct RigidDefinition {
  RigidShape shape;
  double mass = 0;               ///< kg
  Vec3d inertia{};               ///< principal moments [kg m^2]
  BodyPose pose;                 ///< when it was added
  std::vector<Vec3d> particles;  ///< local, of the object's particles [m]
};

}  // namespace souple
