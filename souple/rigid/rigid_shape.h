#pragma once

#include "souple/rigid/convex_shape.h"

#include <vector>

namespace souple {

/// What a body collides with others as: convex parts in its local frame; or, of a body without mass, a collider's shape.
struct RigidShape {
  std::vector<ConvexShape> parts;
  const Shape* collider = nullptr;  ///< a plane or a signed distance field; null: `parts`

  /// Of a ball around the body's center [m]; infinite for planes.
  double radius() const;
  /// The largest ball inside the first part [m]; infinite for colliders.
  double inner_radius() const;
};

}  // namespace souple
