#pragma once

#include "souple/math/mat3.h"

namespace souple::host {

/// Between a host's mesh and the world: x -> linear x + translation. Any invertible one: turned, scaled, also
/// unevenly, sheared, mirrored.
class Placement {
 public:
  Placement() = default;
  /// From a 4 x 4 matrix, column-major, as OpenGL and Eigen hold it: columns of the linear part, then the
  /// translation [m] in 12 to 14. nullptr: nothing is moved. Throws Error, beginning with `name`, when it is
  /// not finite, its last row is not (0, 0, 0, 1), or it cannot be inverted.
  static Placement of(const float* matrix, const char* name = "transform");

  Vec3d to_world(const Vec3d& x) const { return linear_ * x + translation_; }
  Vec3d to_mesh(const Vec3d& x) const { return inverse_ * (x - translation_); }
  bool mirrors() const { return mirrors_; }  ///< turns surfaces inside out

  const Mat3<double>& linear() const { return linear_; }
  const Vec3d& translation() const { return translation_; }

 private:
  Mat3<double> linear_ = Mat3<double>::identity(), inverse_ = Mat3<double>::identity();
  Vec3d translation_{};
  bool mirrors_ = false;
};

}  // namespace souple::host
