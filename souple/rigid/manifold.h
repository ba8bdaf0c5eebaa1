#pragma once

#include "souple/collision/shapes.h"
#include "souple/rigid/convex_shape.h"
#include "souple/state/rigid_bodies.h"

#include <array>
#include <cstdint>
#include <span>

namespace souple {

class MeshShape;

/// One point of a contact of two bodies.
struct ManifoldPoint {
  /// The points of the two surfaces that face each other, in the local frames of a and b [m].
  Vec3d on_a{}, on_b{};
  double separation = 0;      ///< along the normal when found; negative: depth [m]
  std::uint32_t feature = 0;  ///< of the two shapes; equal in consecutive steps: the same contact
};

/// Body with which the normal of a manifold moves.
enum class NormalOwner : std::uint8_t {
  face_of_a,
  face_of_b,
  edges,  ///< two edges or vertices; treat it as fixed to a
};

/// How a moves against b until the manifold is found again, in the world.
struct PairMotion {
  Vec3d path{};  ///< of a's center [m]
  Vec3d turn{};  ///< about it [rad]
};

/// Contact points of two shapes, at most four.
struct Manifold {
  Vec3d normal{};  ///< in the world, unit, from b to a: a is pushed along it
  NormalOwner owner = NormalOwner::edges;
  bool passes = false;  ///< near points do not count, because the shapes pass each other
  int count = 0;
  /// Radii of the surfaces at the points [m], for rounded shapes and for a cylinder on its side. The centers on_a +
  /// normal radius_a (the normal in a's frame) and on_b - normal radius_b stay in place when a shape rolls.
  double radius_a = 0, radius_b = 0;
  std::array<ManifoldPoint, 4> points;
};

/// The four of more points that a manifold kept, by their features.
struct LastPoints {
  int count = 0;  ///< 0 or 4
  std::array<std::uint32_t, 4> features{};
  double area = 0;  ///< that they spanned when they were chosen [m^2]
};

/// The axis that separated a pair best when it was last tested, and the chosen points. Results depend on them, within
/// the tolerances that keep them, so they are part of the state. Start with an empty cache.
struct AxisCache {
  enum class Kind : std::uint8_t { none, face_of_a, face_of_b, edges, closest_points };
  Kind kind = Kind::none;
  std::uint32_t a = 0, b = 0;  ///< faces or edges
  Vec3d axis{};                ///< for other kinds than faces: from a to b, unit, in a's frame
  LastPoints points{};
};

/// Contact points of two shapes where they are nearer than `margin` [m] >= 0. Shapes that are apart give the direction of
/// their closest points, or the normal of a face if that differs by less than the tolerance.
///
/// For polyhedra, face normals and pairs of edges give the axis of least penetration; then one face is clipped against
/// the other. Source: Gregorius, "The Separating Axis Test between Convex Polyhedra", GDC 2013. Two tolerances keep
/// contacts from alternating. Faces are preferred over edges, and the last axis over others, as long as that adds at
/// most `axis_tolerance` to the depth.
///
/// Shapes whose motion leads past each other do not touch where they would only graze. So a box that slides from one box
/// to the next does not hit the next one's side.
Manifold find_manifold(const ConvexShape& a, const BodyPose& pose_a, const ConvexShape& b,
                       const BodyPose& pose_b, double margin, AxisCache& cache,
                       const PairMotion& motion = {});

/// The depth [m] by which the chosen axis of a pair may exceed the least penetration. It is 5e-4 of the smaller outer
/// radius, but at most 5 % of the smaller inner radius.
double axis_tolerance(const ConvexShape& a, const ConvexShape& b);

/// The contact points of a convex shape with a half-space whose local frame has the pose `pose_b`. Keeps the choice of
/// the last call, `points`, while it is as good as a new one.
Manifold find_manifold(const ConvexShape& a, const BodyPose& pose_a, const Plane& b, const BodyPose& pose_b,
                       double margin, LastPoints& points);
Manifold find_manifold(const ConvexShape& a, const BodyPose& pose_a, const Plane& b, const BodyPose& pose_b,
                       double margin);

/// A triangle of a mesh, counterclockwise as seen from the side to which it pushes.
struct ContactTriangle {
  std::array<Vec3d, 3> corners{};  ///< in the mesh's frame [m]
  /// Largest lean of a contact normal over the edge from corner k to the next. The lean is the product of the normal
  /// with the unit vector in the triangle's plane that points out over the edge. It is 0 where the neighbor continues
  /// the plane or rises: a body slides over such an edge. It is the sine of the angle to the neighbor's normal where
  /// the neighbor falls away. It is 1 where that angle exceeds 90 degrees, or without a neighbor.
  std::array<double, 3> lean{1, 1, 1};
};

/// The contact points of a convex shape with a triangle. There are none with a shape whose center is behind its plane. A
/// triangle without area has none.
Manifold find_manifold(const ConvexShape& a, const BodyPose& pose_a, const ContactTriangle& b,
                       const BodyPose& pose_b, double margin, AxisCache& cache,
                       const PairMotion& motion = {});

/// The contact points of a convex shape with a mesh. Each connected piece of the mesh pushes to the side on which the
/// shape's center lies. Triangles with normals of contact within 1 degree share a manifold of at most four points. A
/// vertex of a keeps its feature when it slides from triangle to triangle. Returns the number of manifolds, at most
/// out.size() and 8.
int find_manifolds(const ConvexShape& a, const BodyPose& pose_a, const MeshShape& b, const BodyPose& pose_b,
                   double margin, std::span<Manifold> out, const PairMotion& motion = {});

/// The contact points of a convex shape's vertices with a collider's shape, such as a signed distance field. The
/// collider's local frame has the pose `pose_b`. A manifold gathers the vertices whose normals differ by less than 20
/// degrees from that of its deepest vertex. Returns the number of manifolds, deepest first, at most out.size(). A
/// collider that is smaller than the shape's faces may touch none of the vertices: for convex colliders use
/// convex_shape_of.
int find_manifolds(const ConvexShape& a, const BodyPose& pose_a, const Shape& b, const BodyPose& pose_b,
                   double margin, std::span<Manifold> out);

}  // namespace souple
