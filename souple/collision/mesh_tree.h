#pragma once

#include "souple/geometry/triangle_mesh.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace souple {

/// The triangles of a surface that stands still, in a tree of boxes: how far a point is from them, and how
/// often they go around it. Cut at the median of the centers along the longest side.
class MeshTree {
 public:
  /// At least one triangle; indices in range, positions finite.
  MeshTree(std::span<const Vec3d> positions, std::span<const Triangle> triangles);

  struct Nearest {
    double distance = 0;         ///< [m]
    std::uint32_t triangle = 0;  ///< a guess for points nearby
  };
  /// The distance from a point to the surface, exact to rounding and the same for any guess. A good guess,
  /// the answer for a point nearby, makes it quick. With a tolerance it may be larger by that part of itself:
  /// what is as far from all of a sphere would have to look at all of it.
  Nearest nearest(const Vec3d& point, std::uint32_t guess = 0, double tolerance = 0) const;

  /// How often the surface goes around a point: a whole number for a closed surface that is wound
  /// consistently, but for an error below 0.1 from what is far away.
  ///
  ///   w(p) = sum over triangles of their solid angle / (4 pi)     (Jacobson et al. 2013, eq. 5)
  ///
  /// A box of triangles that is far away for its size counts as one dipole (Barill et al. 2018, eq. 11):
  ///
  ///   w ~ (c - p) . N / (4 pi |c - p|^3),   N the sum of area times normal, c the center weighted by area.
  double winding_number(const Vec3d& point) const;

 private:
  struct Corners {
    Vec3d a, b, c;
    Vec3d middle;   // of a ball that holds them
    double radius;  // [m]
  };
  struct Node {
    Vec3d lo, hi;
    Vec3d center;         // weighted by area
    double radius = 0;    // from there, of all that is in the box [m]
    Vec3d area_normal{};  // sum of area times normal [m^2]
    std::uint32_t begin = 0, end = 0;
    std::uint32_t right = 0;  // the left child is the next node; 0: a leaf
  };
  using Stack = std::array<std::uint32_t, 128>;

  std::uint32_t build(std::uint32_t begin, std::uint32_t end);
  Node node_of(std::uint32_t begin, std::uint32_t end) const;
  static double solid_angle(const Corners& t, const Vec3d& point);
  static double squared_distance(const Corners& t, const Vec3d& point);

  std::vector<Corners> triangles_;  // in the order of the leaves
  std::vector<Node> nodes_;
};

}  // namespace souple
