#pragma once

#include "souple/rigid/joints/rows.h"

namespace souple::joint {

/// A rope from a over two wheels of the world to b, which only pulls:
///
///   C = |a - p| + ratio |b - q| <= length
///
/// With a ratio of 2 the rope is doubled at b, as by a tackle: b feels twice the force of a.
struct Pulley {
  Vec3d wheel_a{}, wheel_b{};  ///< p and q, where the rope leaves for a and b, in the world [m]
  double ratio = 1;
  double length = 0;      ///< of the rope [m]
  double compliance = 0;  ///< m/N
  double damping = 0;     ///< N s/m
};

inline Row rope_row(const Pulley& joint, const Ends& ends) {
  const Vec3d da = ends.point_a - joint.wheel_a, db = ends.point_b - joint.wheel_b;
  const Vec3d na = normalized(da), nb = normalized(db) * joint.ratio;
  return {na, cross(ends.point_a - ends.center_a, na), nb, cross(ends.point_b - ends.center_b, nb),
          length(da) + joint.ratio * length(db)};
}

inline void add_rows(const Pulley& joint, const Ends& ends, Rows& rows) {
  rows.add(rope_row(joint, ends),
           {RowLaw::Kind::range, -unlimited, joint.length, joint.compliance, joint.damping});
}

}  // namespace souple::joint
