#pragma once

#include "souple/rigid/joints/rows.h"

namespace souple::joint {

/// The point of b stays on the first axis of a, and the axes stay parallel.
struct Slider {
  double compliance = 0;          ///< across the axis [m/N]
  double damping = 0;             ///< across the axis [N s/m]
  double angular_compliance = 0;  ///< rad/(N m)
  double angular_damping = 0;     ///< N m s/rad
  Axis translation{};             ///< of b along the first axis [m]
};

inline void add_rows(const Slider& joint, const Ends& ends, Rows& rows) {
  for (int k = 1; k < 3; ++k)
    rows.add(row_across(ends, ends.axes_a.column[k]),
             {RowLaw::Kind::spring, 0, 0, joint.compliance, joint.damping});
  rows.add_rotation(ends, {}, {RowLaw::Kind::spring, 0, 0, joint.angular_compliance, joint.angular_damping});
  rows.add_axis(row_across(ends, ends.axes_a.column[0]), joint.translation);
}

}  // namespace souple::joint
