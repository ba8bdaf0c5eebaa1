#pragma once

#include "souple/rigid/convex_shape.h"

#include <vector>

namespace souple {

/// Shape of a body for collisions: convex parts in its local frame, or a collider's shape for a body without mass.
struct RigidShape {
  std::vector<ConvexShape> parts;
  const Shape* collider = nullptr;  ///< a plane or a signed distance field; null: `parts`

  /// Radius of a ball around the body's center that contains the shape [m]; infinite for planes.
  double radius() const;
  /// The largest ball inside the first part [m]; infinite for colliders.
  double inner_radius() const;
};

}  // namespace souple
