#pragma once

#include "souple/math/elementary.h"
#include "souple/rigid/joints/rows.h"

namespace souple::joint {

/// The points coincide and the first axes are parallel: b rotates about the first axis of a.
struct Hinge {
  double compliance = 0;          ///< of the point [m/N]
  double damping = 0;             ///< of the point [N s/m]
  double angular_compliance = 0;  ///< of the axis [rad/(N m)]
  double angular_damping = 0;     ///< of the axis [N m s/rad]
  Axis rotation{};                ///< of b about the first axis, counted over full turns [rad]
};

/// Rotation of b's frame about the first axis of a's.
inline double hinge_angle(const Ends& ends) {
  const Vec3d &ya = ends.axes_a.column[1], &za = ends.axes_a.column[2];
  const Vec3d &yb = ends.axes_b.column[1], &zb = ends.axes_b.column[2];
  return next_turn(elementary::atan2(dot(yb, za) - dot(zb, ya), dot(yb, ya) + dot(zb, za)), ends.angle[0]);
}

inline void add_rows(const Hinge& joint, const Ends& ends, Rows& rows) {
  rows.add_point(ends, joint.compliance, joint.damping);
  rows.add_parallel_axes(ends, joint.angular_compliance, joint.angular_damping);
  if (!joint.rotation.is_free())
    rows.add_axis(row_about(ends.axes_a.column[0], hinge_angle(ends)), joint.rotation);
}

}  // namespace souple::joint
