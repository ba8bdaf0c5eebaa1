#pragma once

#include "souple/math/vec3.h"

namespace souple::host {

/// From the eye through the mouse, as a host's camera gives it. The direction may have any length but 0.
struct Ray {
  Vec3f origin, direction;  ///< m
};

/// A point that the mouse drags: it stays in the plane through where it was taken, across the view, so it
/// keeps under the mouse and at its depth.
class DragPlane {
 public:
  /// `point` was picked by `pick` [m]; the ray may pass beside it, and the point then stays beside the mouse.
  /// `facing` is where the camera looks; left out, the plane is across the ray. Throws Error when a number is
  /// not finite or the direction is zero.
  DragPlane(const Vec3f& point, const Ray& pick, const Vec3f& facing = {});

  /// Where the point has to go [m]; where it was last when the ray does not meet the plane before the eye, or
  /// is not finite.
  const Vec3f& drag(const Ray& ray);
  const Vec3f& point() const { return point_; }  ///< m

 private:
  bool meet(const Ray& ray, Vec3d& at) const;

  Vec3d through_, normal_;
  Vec3d offset_{};  // from where the picking ray met the plane to the point
  Vec3f point_;
};

}  // namespace souple::host
