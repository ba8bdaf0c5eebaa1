#pragma once

#include "souple/geometry/triangle_mesh.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace souple {

struct HullOptions {
  /// Distance within which points count as coplanar, relative to the size (the diagonal of the points' bounding box),
  /// in [0, 0.1]. A thinner set is flat, a point that lies outside by less becomes no vertex, and triangles in one
  /// plane become one face. The least effective value is 2^-40. The default covers the rounding of coordinates in
  /// float.
  double tolerance = 1e-6;
  /// At most this many vertices, at least 4; 0: no limit. The points that lie farthest outside are kept, so the hull is
  /// inside that of all points; `ConvexHull::excess` bounds the difference.
  std::size_t max_vertices = 0;
};

/// A convex polygon, counterclockwise seen from outside: `count` corners from `begin`.
struct HullFace {
  Vec3d normal;   ///< unit, outward
  double offset;  ///< of its plane: dot(normal, x) <= offset for each vertex x of the hull [m]
  std::uint32_t begin, count;
};

/// A convex polyhedron whose faces are polygons, for the collision of rigid bodies.
struct ConvexHull {
  std::vector<Vec3d> positions;       ///< points of the input, in their order [m]
  std::vector<std::uint32_t> source;  ///< per vertex: its index in the input
  std::vector<HullFace> faces;
  std::vector<std::uint32_t> corners;  ///< vertices, face by face
  /// No point of the input lies farther than this and the tolerance beyond the plane of a face [m]. Without a limit of
  /// vertices about the tolerance at most.
  double excess{};

  std::span<const std::uint32_t> loop(const HullFace& face) const {
    return std::span(corners).subspan(face.begin, face.count);
  }
};

/// The convex hull of points [m]. Vertices are chosen exactly on a grid of 2^-40 of the size, so duplicate, collinear
/// and nearly coplanar points do no harm. The result depends on the points and their order alone. Throws Error, with
/// `name`, for fewer than 4 points, and for points that coincide or lie on a line or in a plane. Also throws for a
/// point that is not finite or beyond 1e9 m, and for options out of range.
ConvexHull convex_hull(std::span<const Vec3d> points, const HullOptions& options = {},
                       const std::string& name = "convex hull");
/// As convex_hull, but none for fewer than 4 points, and for points that coincide or lie on a line or in a plane.
std::optional<ConvexHull> solid_convex_hull(std::span<const Vec3d> points, const HullOptions& options = {},
                                            const std::string& name = "convex hull");

/// The surface as a mesh: closed, wound outward, with the polygons as faces.
TriangleMesh surface_mesh(const ConvexHull& hull);

}  // namespace souple
