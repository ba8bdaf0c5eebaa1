#pragma once

#include "souple/geometry/closest_point.h"
#include "souple/geometry/triangle_mesh.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace souple {

/// On which side of a closed surface a point is: the side of the normal where the surface is nearest to it,
///
///   inside where (p - q) . n < 0,   q the point of the surface nearest to p,
///   n = the triangle's normal within a triangle, the sum of two on an edge, sum of angle times normal at a
///   vertex
///
/// (Baerentzen and Aanaes 2005, "Signed distance computation using the angle weighted pseudonormal"). Nothing
/// is asked about what lies further away, so cavities and pieces within one another have their sides.
///
/// Corners at the same place count as one, triangles without area as none.
class Pseudonormals {
 public:
  /// `triangles` counter-clockwise from outside. Takes positions over [m].
  Pseudonormals(std::vector<Vec3d> positions, std::span<const Triangle> triangles);

  std::size_t size() const { return triangles_.size(); }
  /// The triangles that are left.
  std::array<Vec3d, 3> corners(std::size_t triangle) const;
  /// The normal, of any length, where `nearest` lies on a triangle.
  Vec3d at(std::size_t triangle, const TrianglePoint& nearest) const;

 private:
  std::vector<Vec3d> positions_;
  std::vector<Triangle> triangles_;
  std::vector<std::array<std::uint32_t, 3>> edges_of_triangle_;
  std::vector<Vec3d> of_triangle_, of_edge_, of_vertex_;
};

}  // namespace souple
