#include "souple/rigid/manifold.h"
#include "souple/rigid/manifold_points.h"

namespace souple {
namespace {

using manifold::ContactPoint;
using manifold::ContactPoints;

/// The unit normal and offset of a plane [m].
struct HalfSpace {
  Vec3d normal;
  double offset;
};

HalfSpace half_space(const Plane& plane) {
  const Vec3d normal(plane.normal);
  const double l = length(normal);
  return {normal / l, static_cast<double>(plane.offset) / l};
}

/// Adds a point; a full list is reduced first.
void add(ContactPoints& points, const ContactPoint& point, const Vec3d& normal, double tolerance) {
  if (points.full()) manifold::reduce_to_four(points, normal, tolerance);
  points.push_back(point);
}

}  // namespace

Manifold find_manifold(const ConvexShape& a, const BodyPose& pose_a, const Plane& b, const BodyPose& pose_b,
                       double margin) {
  LastPoints points;
  return find_manifold(a, pose_a, b, pose_b, margin, points);
}

Manifold find_manifold(const ConvexShape& a, const BodyPose& pose_a, const Plane& b, const BodyPose& pose_b,
                       double margin, LastPoints& last) {
  Manifold found;
  const HalfSpace plane = half_space(b);
  const manifold::FrameChange to_plane = manifold::frame_change(pose_a, pose_b);
  // In a's frame.
  const Vec3d normal = to_plane.back(plane.normal);
  const double offset = plane.offset - dot(plane.normal, to_plane.translation) + a.radius;
  if (dot(normal, a.center) - offset - (a.outer_radius - a.radius) >= margin) return found;

  ContactPoints points;
  const double slack = 5e-4 * a.outer_radius;
  for (std::uint32_t v = 0; v < a.vertices.size(); ++v) {
    const double height = dot(normal, a.vertices[v]) - offset;
    if (height >= margin) continue;
    add(points, {a.vertices[v], height, manifold::feature_id(manifold::FeatureKind::vertex_of_a, v, 0)},
        normal, 0.1 * slack);
  }
  manifold::reduce_to_four(points, normal, slack, last);
  found.normal = pose_b.direction(plane.normal);
  found.owner = NormalOwner::face_of_b;
  for (int i = 0; i < points.size(); ++i) {
    const Vec3d on_a = points[i].point - normal * a.radius;
    const Vec3d on_b = to_plane.point(on_a - normal * points[i].height);
    found.points[static_cast<std::size_t>(found.count++)] = {on_a, on_b, points[i].height, points[i].feature};
  }
  return found;
}

}  // namespace souple
