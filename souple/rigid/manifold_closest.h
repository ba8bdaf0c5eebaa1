#pragma once

#include "souple/rigid/manifold_view.h"

namespace souple::manifold {

/// The closest points of two cores.
struct ClosestPoints {
  Vec3d on_a{}, on_b{};  ///< in a's frame [m]
  double distance = 0;   ///< m
  Vec3d axis{};          ///< unit, from a to b; zero where the distance is
  std::uint32_t feature = 0;
};

/// Closest points of cores that are apart (Gilbert, Johnson and Keerthi 1988). `axis`: a first guess of the direction
/// from a to b, not zero. Cores that overlap give no useful result.
ClosestPoints closest_points(const ConvexView& a, const ConvexView& b, const FrameChange& b_to_a,
                             const Vec3d& axis);

}  // namespace souple::manifold
