#include "souple/rigid/manifold_round.h"

#include "souple/rigid/manifold_pair.h"

#include <cmath>

namespace souple::manifold {
RoundView::RoundView(const RoundSide& side) : vertices{side.from, side.to} {
  view.vertices = vertices, view.edges = edges;
  view.radius = side.radius;
  view.center = (side.from + side.to) / 2.0;
  view.outer_radius = length(side.to - side.from) / 2 + side.radius;
}

bool lies_on_side(const ConvexShape& shape, const BodyPose& pose, const Vec3d& normal) {
  return shape.side.radius > 0 && std::abs(dot(pose.direction(shape.side.axis()), normal)) < most_inclined;
}

void drop_beyond(double margin, Manifold& found) {
  int count = 0;
  for (int i = 0; i < found.count; ++i) {
    const ManifoldPoint& p = found.points[static_cast<std::size_t>(i)];
    if (p.separation < margin) found.points[static_cast<std::size_t>(count++)] = p;
  }
  found.count = count;
}

void round_off(const ConvexShape& a, const BodyPose& pose_a, const ConvexShape& b, const BodyPose& pose_b,
               double margin, const PairMotion& local_motion, Manifold& found) {
  const bool round_a = lies_on_side(a, pose_a, found.normal), round_b = lies_on_side(b, pose_b, found.normal);
  if (!round_a && !round_b) return;
  const RoundView side_a(a.side), side_b(b.side);
  ShapePair pair = make_pair(round_a ? side_a.view : view_of(a), round_b ? side_b.view : view_of(b),
                             frame_change(pose_b, pose_a), margin, local_motion);
  Manifold round;
  if (pair.a.faces.empty() && pair.b.faces.empty()) {
    find_segment_points(pair, round);
  } else {
    pair.axis_tolerance = axis_tolerance(a, b);
    AxisCache cache;
    find_points(pair, cache, round);
  }
  if (round.count == 0) return;
  round.normal = pose_a.direction(round.normal);
  round.radius_a = pair.a.radius, round.radius_b = pair.b.radius;
  const bool fits = (!round_a || lies_on_side(a, pose_a, round.normal)) &&
                    (!round_b || lies_on_side(b, pose_b, round.normal));
  if (fits && dot(round.normal, found.normal) > like_normals) found = round;
}

}  // namespace souple::manifold
