#pragma once

#include "souple/collision/shapes.h"
#include "souple/state/rigid_bodies.h"

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace souple {

struct ConvexHull;

constexpr std::uint32_t no_face = ~std::uint32_t(0);

/// A face of a polyhedron: the points with dot(normal, x) = offset. Its corners are corners[begin] up to corners[end].
struct ConvexFace {
  Vec3d normal{};     ///< unit, outward
  double offset = 0;  ///< m
  std::uint32_t begin = 0, end = 0;
};

/// A corner of a face, in the order that is counterclockwise from outside. The edge from it to the face's next corner
/// bounds the face by the side plane, perpendicular to the face.
struct ConvexCorner {
  std::uint32_t vertex = 0;
  std::uint32_t edge = 0;
  Vec3d side_normal{};     ///< unit, in the face's plane, away from the face
  double side_offset = 0;  ///< m
};

/// An edge runs from vertex to vertex, counterclockwise in its left face. The edge of a capsule has no faces.
struct ConvexEdge {
  std::uint32_t from = 0, to = 0;
  std::uint32_t left = no_face, right = no_face;
  double cosine = 1;  ///< between the normals of the two faces
  Vec3d outward{};    ///< between the normals of the two faces; zero without faces
};

/// The round side of a cylinder: its axis from end to end. The polyhedron is a prism inside it.
struct RoundSide {
  Vec3d from{}, to{};  ///< m
  double radius = 0;   ///< 0: none [m]
  double sagitta = 0;  ///< by which the prism's faces lie below the side [m]

  Vec3d axis() const { return normalized(to - from); }
};

/// A convex polyhedron, or a segment or point without faces, and all points within `radius` of it. All in the local
/// frame of a body.
struct ConvexShape {
  std::vector<Vec3d> vertices;  ///< m
  std::vector<ConvexFace> faces;
  std::vector<ConvexCorner> corners;
  std::vector<ConvexEdge> edges;
  RoundSide side{};
  double radius = 0;           ///< of the rounding [m]
  Vec3d center{};              ///< of a ball inside the polyhedron [m]
  double inner_radius = 0;     ///< of that ball, without the rounding [m]
  double outer_radius = 0;     ///< of a ball about the center that contains the shape, with the rounding [m]
  double bounding_radius = 0;  ///< about the frame's origin, with the rounding [m]
  ShapeBounds bounds{};        ///< with the rounding
};

/// The number of corners that a face keeps for contacts; of more, evenly chosen ones remain.
constexpr std::uint32_t max_face_corners = 64;

// All of these throw Error for sizes that are not positive and finite (a capsule's half height may be 0).

ConvexShape convex_sphere(double radius);
/// The segment lies along y.
ConvexShape convex_capsule(double radius, double half_height);
ConvexShape convex_box(const Vec3d& half_extents);
/// Along y. A prism with `sides` >= 3 sides whose vertices lie on the rims; on its side it is round.
ConvexShape convex_cylinder(double radius, double half_height, int sides = 24);

/// The corners of one face, counterclockwise from outside.
using FaceLoop = std::vector<std::uint32_t>;

/// The convex polyhedron with these vertices and faces, rounded by `radius` >= 0. Throws Error if the surface is not
/// closed, an index is out of range, or a face has fewer than three corners or no area. Also throws if a face is not
/// flat, or a vertex is outside a face, by more than 1e-4 of the polyhedron's size.
ConvexShape convex_polyhedron(std::span<const Vec3d> vertices, std::span<const FaceLoop> faces,
                              double radius = 0);

/// The polyhedron of a hull, rounded by `radius` >= 0. The time of a contact test grows with the number of vertices:
/// limit that of finely divided meshes by HullOptions.
ConvexShape convex_polyhedron(const ConvexHull& hull, double radius = 0);

/// The shape of a collider of souple/collision/shapes.h; none for planes and signed distance fields.
std::optional<ConvexShape> convex_shape_of(const Shape& shape);

/// The shape at a pose: in the frame in which the pose is given.
ConvexShape moved(const ConvexShape& shape, const BodyPose& pose);

}  // namespace souple
