#pragma once

#include "souple/rigid/joints/rows.h"

namespace souple::joint {

/// Welds two bodies: the frames coincide.
struct Fixed {
  double compliance = 0;          ///< of the point [m/N]
  double damping = 0;             ///< of the point [N s/m]
  double angular_compliance = 0;  ///< rad/(N m)
  double angular_damping = 0;     ///< N m s/rad
};

inline void add_rows(const Fixed& joint, const Ends& ends, Rows& rows) {
  rows.add_point(ends, joint.compliance, joint.damping);
  rows.add_rotation(ends, {}, {RowLaw::Kind::spring, 0, 0, joint.angular_compliance, joint.angular_damping});
}

}  // namespace souple::joint
