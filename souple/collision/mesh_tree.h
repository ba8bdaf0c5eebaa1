#pragma once

#include "souple/geometry/triangle_mesh.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace souple {

/// Bounding volume hierarchy of a static triangle mesh, for distances and winding numbers of points. Nodes
/// are split at the median of the triangles' centers along the longest side of the box. Each node has a second box
/// along its triangles. Without it, a search among long thin triangles takes three times as long.
class MeshTree {
 public:
  /// Expects at least one triangle, indices in range and finite positions.
  MeshTree(std::span<const Vec3d> positions, std::span<const Triangle> triangles);

  struct Nearest {
    double distance = 0;         ///< [m]
    std::uint32_t triangle = 0;  ///< index in the tree; a guess for points nearby
  };
  /// The distance from a point to the mesh, exact to rounding and the same for any guess. A good guess, such
  /// as the result for a point nearby, makes the search fast. With a tolerance, the distance may be too large by that
  /// part of itself. Without one, a search from the center of a sphere would visit all triangles.
  Nearest nearest(const Vec3d& point, std::uint32_t guess = 0, double tolerance = 0) const;

  /// False if no triangle crosses the segment. Both ends then have one winding number.
  bool may_cross(const Vec3d& from, const Vec3d& to) const;

  /// Generalized winding number: how often the mesh goes around a point. For a closed, consistently wound
  /// mesh it is a whole number, up to an error below 0.1 from the approximation of distant triangles.
  ///
  ///   w(p) = sum over triangles of their solid angle / (4 pi)     (Jacobson et al. 2013, eq. 5)
  ///
  /// A box of triangles that is distant relative to its size counts as one dipole (Barill et al. 2018, eq.
  /// 11):
  ///
  ///   w ~ (c - p) . N / (4 pi |c - p|^3),   N the sum of area times normal, c the area-weighted center.
  double winding_number(const Vec3d& point) const;

 private:
  struct Corners {
    Vec3d a, b, c;
    Vec3d middle;   // center of a ball that contains the corners [m]
    double radius;  // of this ball [m]
  };
  /// A box turned as the triangles lie. It is thin where the axis-parallel box of slanted ones is thick.
  struct Slab {
    Vec3d axis[3];  // unit vectors; the last one along the sum of the triangles' normals
    Vec3d lo, hi;   // along these axes [m]
    bool is_beyond(const Vec3d& point, double distance) const;
  };
  struct Node {
    Vec3d lo, hi;
    Slab slab;
    Vec3d center;         // of the triangles, weighted by area [m]
    double radius = 0;    // of a ball around `center` that contains the box [m]
    Vec3d area_normal{};  // sum of area times normal [m^2]
    std::uint32_t begin = 0, end = 0;
    std::uint32_t right = 0;  // index of the right child, 0 for a leaf; the left child is the next node
  };
  using Stack = std::array<std::uint32_t, 128>;

  std::uint32_t build(std::uint32_t begin, std::uint32_t end);
  Node node_of(std::uint32_t begin, std::uint32_t end) const;
  Slab slab_of(const Node& node) const;
  static double solid_angle(const Corners& t, const Vec3d& point);
  static double squared_distance(const Corners& t, const Vec3d& point);

  std::vector<Corners> triangles_;  // in the order of the leaves
  std::vector<Node> nodes_;
  double rounding_ = 0;  // of distances [m]
};

}  // namespace souple
