#pragma once

#include "souple/math/vec3.h"

namespace souple::host {

/// Ray from the eye through the mouse. The direction may have any length but 0.
struct Ray {
  Vec3f origin, direction;  ///< m
};

/// A point that the mouse drags. It moves in the plane through its initial position that faces the viewer, so
/// it stays under the mouse and at its depth.
class DragPlane {
 public:
  /// `point` was picked by the ray `pick` [m]. If the ray misses the point, the offset persists while
  /// dragging. `facing` is the camera's view direction; by default the plane is perpendicular to the ray.
  /// Throws Error if a number is not finite or the direction is zero.
  DragPlane(const Vec3f& point, const Ray& pick, const Vec3f& facing = {});

  /// New position of the point [m]; its last position if the ray is not finite or does not intersect the
  /// plane in front of the eye.
  const Vec3f& drag(const Ray& ray);
  const Vec3f& point() const { return point_; }  ///< m

 private:
  bool meet(const Ray& ray, Vec3d& at) const;

  Vec3d through_, normal_;
  Vec3d offset_{};  // from the picking ray's intersection with the plane to the point
  Vec3f point_;
};

}  // namespace souple::host
