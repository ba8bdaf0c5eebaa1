#pragma once

#include "souple/geometry/quickhull.h"

#include <cstdint>
#include <span>
#include <vector>

namespace souple {

/// A polygon of a hull.
struct HullPolygon {
  Vec3d normal;                        ///< unit, outward
  double offset;                       ///< the largest dot(normal, x) of the hull [m]
  std::vector<std::uint32_t> corners;  ///< vertices, counterclockwise seen from outside
  std::vector<std::uint32_t> across;   ///< per corner: the polygon beyond the edge to the next corner
};

struct HullPolygons {
  std::vector<HullPolygon> polygons;
  std::vector<std::uint32_t> of_triangle;  ///< per triangle of the hull: its polygon
};

/// Joins triangles of a hull that lie in one plane within `tolerance` [m] to convex polygons, the largest triangles first.
/// Vertices inside a polygon, and those on a straight edge between two, are no corners. Where joined triangles would not be
/// convex within the tolerance, they stay apart, so every result is a closed surface of disks.
HullPolygons merge_coplanar(std::span<const Vec3d> positions, const HullTriangles& hull, double tolerance);

}  // namespace souple
