#include "souple/rigid/manifold.h"

#include "souple/rigid/manifold_pair.h"

#include <algorithm>

namespace souple {

double axis_tolerance(const ConvexShape& a, const ConvexShape& b) {
  const double outer = std::min(a.outer_radius, b.outer_radius);
  const double inner = std::min(a.inner_radius + a.radius, b.inner_radius + b.radius);
  return std::min(5e-4 * outer, 0.05 * inner);
}

Manifold find_manifold(const ConvexShape& a, const BodyPose& pose_a, const ConvexShape& b,
                       const BodyPose& pose_b, double margin, AxisCache& cache) {
  Manifold found;
  const Vec3d between = pose_b.point(b.center) - pose_a.point(a.center);
  const double reach = a.outer_radius + b.outer_radius + margin;
  if (length_squared(between) >= reach * reach) return found;
  manifold::ShapePair pair = manifold::make_pair(manifold::view_of(a), manifold::view_of(b),
                                                 manifold::frame_change(pose_b, pose_a), margin);
  if (a.faces.empty() && b.faces.empty()) {
    manifold::find_segment_points(pair, found);
  } else {
    pair.axis_tolerance = axis_tolerance(a, b);
    manifold::find_points(pair, cache, found);
  }
  if (found.count > 0) found.normal = pose_a.direction(found.normal);
  return found;
}

}  // namespace souple
