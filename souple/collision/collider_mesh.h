#pragma once

#include "souple/collision/shapes.h"
#include "souple/geometry/triangle_mesh.h"

#include <vector>

namespace souple {

/// Triangle mesh for drawing a collider, in its own frame: smooth where the shape is smooth, sharp at the
/// edges of boxes and cylinders.
struct ColliderMesh {
  std::vector<Vec3f> positions;  ///< on the shape's surface [m]
  std::vector<Vec3f> normals;    ///< unit, outward; one per position
  std::vector<Triangle> triangles;
};

/// The mesh of a shape. A plane becomes a square of 2 `extent` [m] around the point nearest to `center`.
ColliderMesh collider_mesh(const Shape& shape, const Vec3d& center, double extent);

}  // namespace souple
