#pragma once

#include "souple/contacts/contact_material.h"
#include "souple/rigid/manifold.h"

#include <array>
#include <cstdint>

namespace souple {

/// A point at which two rigid bodies a and b touch or may touch within the step. Local points are in the bodies' frames.
///
/// A rounded body is a core and all points within a radius of it. The contact is between two points of the cores:
///   C = n . (x_a - x_b) - R,   R = radius_a + radius_b, n from b to a. [m]
struct RigidContactPoint {
  Vec3d core_a{}, core_b{};      ///< local [m]
  Vec3d anchor_a{}, anchor_b{};  ///< local: material points that friction holds together [m]
  std::uint32_t feature = 0;     ///< of the manifold: the same in consecutive steps for the same contact
  bool anchored = false;         ///< whether the anchors are those of the last substep
  bool slid = false;             ///< friction reached its limit in the last substep
  double normal_impulse = 0;     ///< of the last substep: force times h^2 [kg m]
  Vec3d tangent_impulse{};       ///< likewise, in world axes [kg m]
};

/// All points at which two rigid bodies touch.
struct RigidContact {
  std::uint32_t a = 0, b = 0;  ///< bodies, or no_body
  ContactMaterialPair material;
  double radius_a = 0, radius_b = 0;  ///< of rounded bodies [m]
  /// Unit vector from b to a: local to body a, to body b if b's face gives it.
  Vec3d normal{};
  NormalOwner owner = NormalOwner::edges;
  /// Two rounded points face each other: the normal is along the line between them.
  bool normal_between_points = false;
  std::uint8_t count = 0;  ///< of points
  std::array<RigidContactPoint, 4> points{};
};

}  // namespace souple
