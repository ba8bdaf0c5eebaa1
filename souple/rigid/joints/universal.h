#pragma once

#include "souple/math/elementary.h"
#include "souple/rigid/joints/rows.h"

namespace souple::joint {

/// A Cardan joint: the points coincide, and the third axis of b stays perpendicular to the first axis of a. b is turned
/// about the first axis of a by `first`, then about its own third axis by `second`.
struct Universal {
  double compliance = 0;          ///< of the point [m/N]
  double damping = 0;             ///< of the point [N s/m]
  double angular_compliance = 0;  ///< of the right angle [rad/(N m)]
  double angular_damping = 0;     ///< of the right angle [N m s/rad]
  Axis first{};                   ///< rad
  Axis second{};                  ///< rad
};

/// Rotations about both axes.
inline std::array<double, 2> universal_angles(const Ends& ends) {
  const Vec3d &x = ends.axes_a.column[0], &z = ends.axes_b.column[2];
  const double first = elementary::atan2(-dot(z, ends.axes_a.column[1]), dot(z, ends.axes_a.column[2]));
  const double second = elementary::atan2(-dot(x, ends.axes_b.column[1]), dot(x, ends.axes_b.column[0]));
  return {next_turn(first, ends.angle[0]), next_turn(second, ends.angle[1])};
}

inline void add_rows(const Universal& joint, const Ends& ends, Rows& rows) {
  const Vec3d &x = ends.axes_a.column[0], &z = ends.axes_b.column[2];
  rows.add_point(ends, joint.compliance, joint.damping);
  rows.add(row_about(cross(z, x), dot(x, z)),
           {RowLaw::Kind::spring, 0, 0, joint.angular_compliance, joint.angular_damping});
  if (joint.first.is_free() && joint.second.is_free()) return;
  const std::array<double, 2> angle = universal_angles(ends);
  rows.add_axis(row_about(x, angle[0]), joint.first);
  rows.add_axis(row_about(z, angle[1]), joint.second);
}

}  // namespace souple::joint
