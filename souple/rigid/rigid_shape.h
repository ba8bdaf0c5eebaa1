#pragma once

#include "souple/rigid/convex_shape.h"
#include "souple/rigid/mesh_shape.h"

#include <memory>
#include <vector>

namespace souple {

/// Shape of a body for collisions: convex parts in its local frame; for a body without mass also a collider's shape or a
/// mesh.
struct RigidShape {
  std::vector<ConvexShape> parts;
  const Shape* collider = nullptr;          ///< a plane or a signed distance field; null: not
  std::shared_ptr<const MeshShape> mesh{};  ///< an obstacle's; null: not

  /// Radius of a ball around the body's center that contains the shape [m]; infinite for planes.
  double radius() const;
  /// The largest ball inside the first part [m]; infinite without parts.
  double inner_radius() const;
};

}  // namespace souple
