#pragma once

#include "souple/rigid/joints/rows.h"

namespace souple::joint {

/// Keeps the distance of two points between two lengths. A rod has equal lengths, a rope the shortest length 0. The
/// gradient of coincident points is zero.
struct Distance {
  double shortest = 0, longest = 0;  ///< m
  double compliance = 0;             ///< m/N
  double damping = 0;                ///< N s/m
  std::optional<Motor> motor{};      ///< changes the distance, as a winch does
};

inline Row distance_row(const Ends& ends) {
  const Vec3d d = ends.point_b - ends.point_a;
  const double l = length(d);
  const Vec3d n = l > 0 ? d / l : Vec3d{};
  return {-n, -cross(ends.point_a - ends.center_a, n), n, cross(ends.point_b - ends.center_b, n), l};
}

inline void add_rows(const Distance& joint, const Ends& ends, Rows& rows) {
  const Row row = distance_row(ends);
  const bool rod = joint.shortest == joint.longest;
  rows.add(row, {rod ? RowLaw::Kind::spring : RowLaw::Kind::range, joint.shortest, joint.longest,
                 joint.compliance, joint.damping});
  rows.add_axis(row, {{}, {}, joint.motor});
}

}  // namespace souple::joint
