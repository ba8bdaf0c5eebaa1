#pragma once

#include "souple/math/mat3.h"

namespace souple::host {

/// Affine transform from a host's mesh to the world: x -> linear x + translation. Any invertible one is
/// valid, also with non-uniform scale, shear or reflection.
class Placement {
 public:
  Placement() = default;
  /// From a column-major 4 x 4 matrix, as OpenGL and Eigen store it. The columns of the linear part come first, the
  /// translation [m] is at indices 12 to 14. nullptr: the identity. Throws Error, beginning with `name`, if the matrix
  /// is not finite, its last row is not (0, 0, 0, 1), or it is singular.
  static Placement of(const float* matrix, const char* name = "transform");

  Vec3d to_world(const Vec3d& x) const { return linear_ * x + translation_; }
  Vec3d to_mesh(const Vec3d& x) const { return inverse_ * (x - translation_); }
  bool mirrors() const { return mirrors_; }  ///< negative determinant: reverses the winding of triangles

  const Mat3<double>& linear() const { return linear_; }
  const Vec3d& translation() const { return translation_; }

 private:
  Mat3<double> linear_ = Mat3<double>::identity(), inverse_ = Mat3<double>::identity();
  Vec3d translation_{};
  bool mirrors_ = false;
};

}  // namespace souple::host
