#include "souple/rigid/manifold.h"

#include "souple/rigid/manifold_pair.h"
#include "souple/rigid/manifold_round.h"

#include <algorithm>

namespace souple {

double axis_tolerance(const ConvexShape& a, const ConvexShape& b) {
  const double outer = std::min(a.outer_radius, b.outer_radius);
  const double inner = std::min(a.inner_radius + a.radius, b.inner_radius + b.radius);
  return std::min(5e-4 * outer, 0.05 * inner);
}

Manifold find_manifold(const ConvexShape& a, const BodyPose& pose_a, const ConvexShape& b,
                       const BodyPose& pose_b, double margin, AxisCache& cache, const PairMotion& motion) {
  Manifold found;
  const Vec3d between = pose_b.point(b.center) - pose_a.point(a.center);
  const double reach = a.outer_radius + b.outer_radius + margin;
  if (length_squared(between) >= reach * reach) return found;
  const double sagitta = a.side.sagitta + b.side.sagitta;
  manifold::ShapePair pair =
      manifold::make_pair(manifold::view_of(a), manifold::view_of(b), manifold::frame_change(pose_b, pose_a),
                          margin + sagitta, manifold::local_motion(pose_a, motion));
  if (a.faces.empty() && b.faces.empty()) {
    manifold::find_segment_points(pair, found);
  } else {
    pair.axis_tolerance = axis_tolerance(a, b);
    manifold::find_points(pair, cache, found);
  }
  if (found.count == 0) return found;
  found.normal = pose_a.direction(found.normal);
  found.radius_a = a.radius, found.radius_b = b.radius;
  if (sagitta > 0) {
    manifold::round_off(a, pose_a, b, pose_b, pair.margin, pair.motion, found);
    manifold::drop_beyond(margin, found);
  }
  return found;
}

}  // namespace souple
