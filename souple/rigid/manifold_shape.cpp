#include "souple/rigid/manifold.h"
#include "souple/rigid/manifold_points.h"

namespace souple {
namespace {

using manifold::ContactPoints;
using manifold::FrameChange;

/// Vertices whose normals differ by less than 20 degrees share a manifold: the product of the normals exceeds this.
constexpr double near_normals = 0.94;

/// A vertex near the collider, in the collider's frame.
struct NearVertex {
  Vec3d point, normal;
  double separation;
  std::uint32_t vertex;
  bool taken;
};
using NearVertices = manifold::StackList<NearVertex, 256>;

/// Adds a vertex. In a full list it replaces the farthest one, if that is farther.
void add(NearVertices& list, const NearVertex& vertex) {
  if (!list.full()) return list.push_back(vertex);
  int farthest = 0;
  for (int i = 1; i < list.size(); ++i) {
    if (list[i].separation > list[farthest].separation) farthest = i;
  }
  if (list[farthest].separation > vertex.separation) list[farthest] = vertex;
}

void find_near(const ConvexShape& a, const FrameChange& to_b, const Shape& b, double margin,
               NearVertices& list) {
  for (std::uint32_t v = 0; v < a.vertices.size(); ++v) {
    const Vec3d point = to_b.point(a.vertices[v]);
    const SurfaceDistance surface = surface_distance(b, point);
    const double separation = surface.distance - a.radius;
    if (separation < margin) add(list, {point, surface.normal, separation, v, false});
  }
}

/// The deepest vertex without a manifold, or -1.
int deepest_left(const NearVertices& list) {
  int deepest = -1;
  for (int i = 0; i < list.size(); ++i) {
    if (!list[i].taken && (deepest < 0 || list[i].separation < list[deepest].separation)) deepest = i;
  }
  return deepest;
}

/// The vertices of a manifold with the normal of vertex `first`, at most four.
void gather(NearVertices& list, int first, double tolerance, ContactPoints& points) {
  const Vec3d normal = list[first].normal;
  for (int i = 0; i < list.size(); ++i) {
    if (list[i].taken || dot(list[i].normal, normal) < near_normals) continue;
    list[i].taken = true;
    if (points.full()) manifold::reduce_to_four(points, normal, tolerance);
    points.push_back({list[i].point, list[i].separation,
                      manifold::feature_id(manifold::FeatureKind::vertex_of_a, list[i].vertex, 0)});
  }
  list[first].taken = true;
  manifold::reduce_to_four(points, normal, tolerance);
}

}  // namespace

int find_manifolds(const ConvexShape& a, const BodyPose& pose_a, const Shape& b, const BodyPose& pose_b,
                   double margin, std::span<Manifold> out) {
  const FrameChange to_b = manifold::frame_change(pose_a, pose_b), to_a = manifold::inverse(to_b);
  NearVertices list;
  find_near(a, to_b, b, margin, list);
  int count = 0;
  for (int first = deepest_left(list); first >= 0 && count < static_cast<int>(out.size());
       first = deepest_left(list)) {
    ContactPoints points;
    const Vec3d normal = list[first].normal;
    gather(list, first, 5e-5 * a.outer_radius, points);
    Manifold& found = out[static_cast<std::size_t>(count++)];
    found = {.normal = pose_b.direction(normal),
             .owner = NormalOwner::face_of_b,
             .radius_a = a.radius,
             .points = {}};
    for (int i = 0; i < points.size(); ++i) {
      const Vec3d on_a = points[i].point - normal * a.radius;
      found.points[static_cast<std::size_t>(found.count++)] = {
          to_a.point(on_a), on_a - normal * points[i].height, points[i].height, points[i].feature};
    }
  }
  return count;
}

}  // namespace souple
