#pragma once

#include "souple/math/mat3.h"
#include "souple/math/vec3.h"

#include <array>

namespace souple {

/// Sums over particles relative to a point near them: mass, m x, m v, m x x^T (lower triangle), m x cross v.
struct RigidSums {
  double mass = 0;
  Vec3d position, momentum;
  std::array<double, 6> second{};
  Vec3d angular;

  void add(double m, const Vec3d& x, const Vec3d& v);
  void add(const RigidSums& more);
  /// About the center of mass. [kg m^2]
  Mat3d inertia() const;
};

/// The angular velocity that has the angular momentum L. A rod or a point has no inertia about its axis, hence no spin there:
/// a small relative inertia is added.
Vec3d spin_of(const Mat3d& inertia, const Vec3d& L);

}  // namespace souple
