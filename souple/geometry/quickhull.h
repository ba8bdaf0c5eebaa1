#pragma once

#include "souple/geometry/triangle_mesh.h"
#include "souple/math/vec3.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace souple {

// The convex hull of points on an integer grid, as triangles (convex_hull.h makes polygons of them). On which side of a plane
// a point lies is decided exactly, in integers of 128 bits. So the triangles are always a closed convex surface, however the
// points are arranged.

/// A point in units of the grid.
using GridPoint = Vec3<std::int64_t>;
/// Coordinates are in [0, 2^grid_bits]: six products of three differences fit in 127 bits.
inline constexpr int grid_bits = 40;

/// Four points that span a tet of the largest extent. There are fewer if all points lie within the tolerance of a
/// plane, a line or a point: the first `count` corners are valid.
struct Simplex {
  std::array<std::uint32_t, 4> corners{};
  std::size_t count{};
};
Simplex find_simplex(std::span<const GridPoint> points, double tolerance);

/// Triangles over the points, wound outward, and the points outside of them.
struct HullTriangles {
  std::vector<Triangle> triangles;
  std::vector<Triangle>
      neighbors;  ///< per triangle: those across its sides; side i joins corners i and (i + 1) % 3
  std::vector<Vec3d> normals;  ///< unit, outward

  /// A point that is not in the hull, and the triangle whose plane it lies farthest beyond.
  struct Outside {
    std::uint32_t point, triangle;
  };
  std::vector<Outside> outside;
};

/// Adds the point that lies farthest outside, again and again, until none is farther than `tolerance` beyond any triangle's
/// plane [grid units, >= 1] or the hull has `max_vertices` >= 4. `simplex` must have 4 corners. Quickhull (Barber, Dobkin and
/// Huhdanpaa 1996, "The quickhull algorithm for convex hulls", ACM Trans. Math. Softw. 22(4)). Ties go to the lower index.
HullTriangles quickhull(std::span<const GridPoint> points, const Simplex& simplex, double tolerance,
                        std::size_t max_vertices);

}  // namespace souple
