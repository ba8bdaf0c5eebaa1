#include "souple/rigid/manifold.h"
#include "souple/rigid/manifold_points.h"
#include "souple/rigid/manifold_round.h"

#include <array>

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

/// A plane in the frame of a shape, less the shape's rounding.
struct LocalPlane {
  Vec3d normal;
  double offset, margin, slack;
  double height(const Vec3d& x) const { return dot(normal, x) - offset; }
};

void add_vertices(const ConvexShape& a, const LocalPlane& plane, ContactPoints& points) {
  for (std::uint32_t v = 0; v < a.vertices.size(); ++v) {
    const double height = plane.height(a.vertices[v]);
    if (height >= plane.margin) continue;
    const std::uint32_t feature = manifold::feature_id(manifold::FeatureKind::vertex_of_a, v, 0);
    add(points, {a.vertices[v], height, feature}, plane.normal, 0.1 * plane.slack);
  }
}

/// The lowest points of a cylinder's two rims. False if it nearly stands: then the prism's vertices are as good. `lies`:
/// whether it lies on its side; then the points are below the ends of its axis.
bool add_rims(const RoundSide& side, const LocalPlane& plane, bool lies, ContactPoints& points) {
  const Vec3d axis = side.axis();
  const Vec3d across = plane.normal - axis * dot(plane.normal, axis);
  constexpr double standing = 0.2;
  if (length_squared(across) < standing * standing) return false;
  const Vec3d down = (lies ? plane.normal : normalized(across)) * -side.radius;
  const std::array<Vec3d, 2> rims{side.from + down, side.to + down};
  for (std::uint32_t k = 0; k < 2; ++k) {
    const double height = plane.height(rims[k]);
    if (height >= plane.margin) continue;
    points.push_back({rims[k], height, manifold::feature_id(manifold::FeatureKind::other, k, 0)});
  }
  return true;
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
  const Vec3d normal = to_plane.back(plane.normal);
  const double offset = plane.offset - dot(plane.normal, to_plane.translation) + a.radius;
  if (dot(normal, a.center) - offset - (a.outer_radius - a.radius) >= margin) return found;

  found.normal = pose_b.direction(plane.normal);
  found.owner = NormalOwner::face_of_b;
  const bool lies = manifold::lies_on_side(a, pose_a, found.normal);
  found.radius_a = lies ? a.side.radius : a.radius;
  const LocalPlane local{normal, offset, margin, 5e-4 * a.outer_radius};
  ContactPoints points;
  if (!(a.side.radius > 0) || !add_rims(a.side, local, lies, points)) add_vertices(a, local, points);
  manifold::reduce_to_four(points, normal, local.slack, last);
  for (int i = 0; i < points.size(); ++i) {
    const Vec3d on_a = points[i].point - normal * a.radius;
    const Vec3d on_b = to_plane.point(on_a - normal * points[i].height);
    found.points[static_cast<std::size_t>(found.count++)] = {on_a, on_b, points[i].height, points[i].feature};
  }
  return found;
}

}  // namespace souple
