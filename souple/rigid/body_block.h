#pragma once

#include "souple/math/mat3.h"
#include "souple/rigid/impulse.h"

namespace souple {

/// The quadratic model of one body's part of
///   1/(2 h^2) |x - x*|^2_M + sum_j E_j(x),
/// the energy that a substep of implicit Euler minimizes: constraints add their forces and stiffnesses at the current
/// pose, `step` returns the minimum. Chen et al. 2024, "Vertex Block Descent", eq. 8; for rigid bodies Giles, Diaz and
/// Yuksel 2025, "Augmented Vertex Block Descent", section 3.
struct BodyBlock {
  Vec3d force{}, torque{};  ///< -gradient [N], about the center of mass [N m]
  /// The Hessian (linear, coupling^T; coupling, angular): [N/m], [N], [N m].
  Mat3d linear{}, coupling{}, angular{};

  /// The inertia: mass [kg], inertia in world axes [kg m^2]; dx and dtheta: pose relative to the predicted one.
  BodyBlock(double mass, const Mat3d& inertia, double inverse_h2, const Vec3d& dx, const Vec3d& dtheta)
      : force(dx * (-mass * inverse_h2)), torque(inertia * dtheta * -inverse_h2) {
    const double m = mass * inverse_h2;
    linear = Mat3d::diagonal({m, m, m});
    angular = inertia * inverse_h2;
  }

  /// A force at center + r, with a stiffness that is the same in all directions [N/m].
  void add(const Vec3d& r, const Vec3d& f, double stiffness) {
    force += f, torque += cross(r, f);
    for (int k = 0; k < 3; ++k) linear.column[k][k] += stiffness;
    coupling = coupling + cross_matrix(r * stiffness);
    // -[r][r] = |r|^2 - r r^T
    const double r2 = dot(r, r) * stiffness;
    angular = angular + (Mat3d::diagonal({r2, r2, r2}) - outer(r * stiffness, r));
  }
  /// A force at center + r, with a stiffness along the unit vector n alone.
  void add(const Vec3d& r, const Vec3d& f, const Vec3d& n, double stiffness) {
    force += f, torque += cross(r, f);
    const Vec3d rn = cross(r, n);
    linear = linear + outer(n * stiffness, n);
    coupling = coupling + outer(rn * stiffness, n);
    angular = angular + outer(rn * stiffness, rn);
  }

  struct Step {
    Vec3d dx{}, dtheta{};
  };
  /// Newton's step: by the Schur complement of the linear block.
  Step step() const {
    const Mat3d A = inverse(linear), BA = coupling * A;
    const Mat3d S = angular - BA * transpose(coupling);
    const Vec3d dtheta = inverse(S) * (torque - BA * force);
    return {A * (force - transpose(coupling) * dtheta), dtheta};
  }
};

}  // namespace souple
