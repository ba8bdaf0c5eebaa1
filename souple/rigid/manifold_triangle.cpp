#include "souple/rigid/manifold.h"
#include "souple/rigid/manifold_pair.h"
#include "souple/rigid/manifold_round.h"

#include <algorithm>

namespace souple {
namespace {

using manifold::ConvexView;
using manifold::NormalRegion;

/// A triangle as a polyhedron of two faces, in the frame of a shape. Its edges lie between the front and the planes of
/// its sides: so their normals are those in front of the triangle.
struct FlatPolyhedron {
  std::array<Vec3d, 3> vertices;
  std::array<ConvexFace, 5> faces;  // front, back, sides
  std::array<ConvexCorner, 6> corners;
  std::array<ConvexEdge, 3> edges;
  ConvexView view;
  NormalRegion region;
};

/// The plane through the triangle's edge from corner k, perpendicular to the triangle.
ConvexCorner corner_of(const std::array<Vec3d, 3>& x, std::uint32_t from, std::uint32_t to,
                       std::uint32_t edge, const Vec3d& normal) {
  const Vec3d side = normalized(cross(x[to] - x[from], normal));
  return {from, edge, side, dot(side, x[from])};
}

/// False if the triangle has no area. `lean` belongs to the edge after each of the vertices.
bool fill(FlatPolyhedron& flat, const std::array<double, 3>& lean) {
  const std::array<Vec3d, 3>& x = flat.vertices;
  const Vec3d area = cross(x[1] - x[0], x[2] - x[0]);
  const double longest =
      std::max({length_squared(x[1] - x[0]), length_squared(x[2] - x[1]), length_squared(x[0] - x[2])});
  if (!(length_squared(area) > 1e-24 * longest * longest)) return false;
  const Vec3d n = normalized(area);
  flat.faces[0] = {n, dot(n, x[0]), 0, 3};
  flat.faces[1] = {-n, -dot(n, x[0]), 3, 6};
  for (std::uint32_t k = 0; k < 3; ++k) {
    const std::uint32_t next = (k + 1) % 3, back = 2 - k;
    flat.corners[k] = corner_of(x, k, next, k, n);
    flat.corners[3 + back] = corner_of(x, next, k, k, -n);
    const Vec3d side = flat.corners[k].side_normal;
    flat.faces[2 + k] = {side, flat.corners[k].side_offset, 0, 0};
    flat.edges[k] = {k, next, 0, 2 + k, 0, normalized(n + side)};
    flat.region.outward[k] = side;
    flat.region.lean[k] = lean[k];
  }
  flat.region.normal = n;
  flat.view = {.vertices = flat.vertices,
               .faces = std::span(flat.faces).first(2),
               .corners = flat.corners,
               .edges = flat.edges,
               .edge_faces = flat.faces.data()};
  flat.view.center = (x[0] + x[1] + x[2]) / 3.0;
  for (const Vec3d& v : x)
    flat.view.outer_radius = std::max(flat.view.outer_radius, length(v - flat.view.center));
  return true;
}

}  // namespace

Manifold find_manifold(const ConvexShape& a, const BodyPose& pose_a, const ContactTriangle& b,
                       const BodyPose& pose_b, double margin, AxisCache& cache, const PairMotion& motion) {
  Manifold found;
  const manifold::FrameChange to_a = manifold::frame_change(pose_b, pose_a);
  FlatPolyhedron flat;
  for (std::size_t k = 0; k < 3; ++k) flat.vertices[k] = to_a.point(b.corners[k]);
  if (!fill(flat, b.lean)) return found;
  const double height = dot(flat.region.normal, a.center - flat.vertices[0]);
  if (height >= a.outer_radius + margin || height < 0) return found;
  const double tolerance =
      std::min(5e-4 * std::min(a.outer_radius, flat.view.outer_radius), 0.05 * (a.inner_radius + a.radius));
  // The shape's vertices keep their features from triangle to triangle if the triangle is the reference.
  if (cache.kind == AxisCache::Kind::none) cache.kind = AxisCache::Kind::face_of_b, cache.b = 0;
  const auto find = [&](const ConvexView& view, AxisCache& last) {
    manifold::ShapePair pair = manifold::make_pair(view, flat.view, {}, margin + a.side.sagitta,
                                                   manifold::local_motion(pose_a, motion));
    pair.region = &flat.region;
    pair.axis_tolerance = tolerance;
    Manifold out;
    manifold::find_points(pair, last, out);
    out.normal = pose_a.direction(out.normal);
    out.radius_a = view.radius;
    return out;
  };
  found = find(manifold::view_of(a), cache);
  if (found.count > 0 && manifold::lies_on_side(a, pose_a, found.normal)) {
    const manifold::RoundView side(a.side);
    AxisCache fresh{.kind = AxisCache::Kind::face_of_b};
    const Manifold round = find(side.view, fresh);
    const bool fits = round.count > 0 && manifold::lies_on_side(a, pose_a, round.normal);
    if (fits && dot(round.normal, found.normal) > manifold::like_normals) found = round;
  }
  if (a.side.sagitta > 0) manifold::drop_beyond(margin, found);
  for (int i = 0; i < found.count; ++i) {
    Vec3d& on_b = found.points[static_cast<std::size_t>(i)].on_b;
    on_b = to_a.back(on_b - to_a.translation);
  }
  return found;
}

}  // namespace souple
