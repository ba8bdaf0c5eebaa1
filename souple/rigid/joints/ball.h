#pragma once

#include "souple/math/elementary.h"
#include "souple/rigid/joints/rows.h"

namespace souple::joint {

/// The points coincide. The first axes point alike at rest: `max_swing` limits the angle between them, `twist` the
/// rotation about them.
///
///   swing = atan2(|x_a x x_b|, x_a . x_b),   gradient n = x_a x x_b / |x_a x x_b|
///   twist = 2 atan2(q_x, q_w) of the relative rotation q,   gradient (x_a + x_b) / (1 + x_a . x_b)
///
/// Undefined: the swing's gradient where it is 0 or pi, the twist where the swing is pi. Both gradients are 0 there.
struct Ball {
  double compliance = 0;         ///< of the point [m/N]
  double damping = 0;            ///< of the point [N s/m]
  double max_swing = unlimited;  ///< rad, in [0, pi]
  double swing_compliance = 0;   ///< beyond the limit [rad/(N m)]
  Limits twist{};                ///< within [-pi, pi]
  std::optional<RotationSpring> spring{};
};

inline Row swing_row(const Ends& ends) {
  const Vec3d &a = ends.axes_a.column[0], &b = ends.axes_b.column[0];
  const Vec3d n = cross(a, b);
  const double sine = length(n);
  return row_about(sine > 1e-9 ? n / sine : Vec3d{}, elementary::atan2(sine, dot(a, b)));
}

inline Row twist_row(const Ends& ends) {
  const Vec3d &a = ends.axes_a.column[0], &b = ends.axes_b.column[0];
  const Quatd q = relative_rotation(ends);
  const double cosine = 1 + dot(a, b);
  return row_about(cosine > 1e-9 ? (a + b) / cosine : Vec3d{}, 2 * elementary::atan2(q.x, q.w));
}

inline void add_rows(const Ball& joint, const Ends& ends, Rows& rows) {
  rows.add_point(ends, joint.compliance, joint.damping);
  if (joint.max_swing < unlimited)
    rows.add_limits(swing_row(ends), {-unlimited, joint.max_swing, joint.swing_compliance, 0});
  rows.add_limits(twist_row(ends), joint.twist);
  if (joint.spring)
    rows.add_rotation(ends, joint.spring->target,
                      {RowLaw::Kind::spring, 0, 0, joint.spring->compliance, joint.spring->damping,
                       joint.spring->max_torque, true});
}

}  // namespace souple::joint
