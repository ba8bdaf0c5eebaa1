#pragma once

#include "souple/geometry/tet_mesh.h"
#include "souple/geometry/triangle_mesh.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

namespace souple {

// Lengths, areas, volumes and masses of meshes. Indices must be in range (check_indices in adjacency.h).

/// An axis-aligned box.
struct BoundingBox {
  Vec3d lo, hi;
  Vec3d size() const { return hi - lo; }
  Vec3d center() const { return lo / 2 + hi / 2; }
  double diagonal() const { return length(hi - lo); }
};
/// The box of all finite positions; without any, a point at the origin.
BoundingBox bounding_box(std::span<const Vec3d> positions);
/// The box of the corners of triangles.
BoundingBox bounding_box(std::span<const Vec3d> positions, std::span<const Triangle> triangles);

/// Total area of all triangles [m^2].
double surface_area(std::span<const Vec3d> positions, std::span<const Triangle> triangles);

/// Volume enclosed by a closed surface [m^3], positive if it is wound outward. Meaningless for an open
/// surface.
double enclosed_volume(std::span<const Vec3d> positions, std::span<const Triangle> triangles);

/// Signed volume of each tet [m^3] (positive by the convention of Tet), and their sum.
std::vector<double> tet_volumes(const TetMesh& mesh);
double tet_volume(const TetMesh& mesh);

/// Mass per vertex [kg]: a third of the mass of each adjacent triangle (areal density [kg/m^2]), or a quarter
/// of each adjacent tet's (density [kg/m^3]). An unused vertex has mass 0.
std::vector<double> lumped_masses(std::span<const Vec3d> positions, std::span<const Triangle> triangles,
                                  double areal_density);
std::vector<double> lumped_masses(const TetMesh& mesh, double density);

/// Radius of the smallest circle that contains a triangle [m]; with b = c, of the one around an edge.
inline double enclosing_radius(const Vec3d& x, const Vec3d& y, const Vec3d& z) {
  const double a = length_squared(y - z), b = length_squared(z - x), c = length_squared(x - y);
  const double longest = std::max(a, std::max(b, c)), area = length(cross(y - x, z - x));
  if (2 * longest >= a + b + c) return 0.5 * std::sqrt(longest);
  return std::sqrt(a * b * c) / (2 * area);
}

/// Normalizes a sum of triangle normals; zero stays zero.
template <class T>
Vec3<T> unit_normal(const Vec3<T>& n) {
  // Scaled to size 1 first: the square of a millimeter triangle's normal underflows in a float.
  const T largest = std::max({std::abs(n.x), std::abs(n.y), std::abs(n.z)});
  return largest > T(0) ? normalized(n / largest) : Vec3<T>{};
}

/// Unit vertex normals, weighted by triangle area, into `normals` (one per position); zero if undefined.
/// Allocates nothing.
template <class T>
void vertex_normals(std::span<const Vec3<T>> positions, std::span<const Triangle> triangles,
                    std::span<Vec3<T>> normals) {
  for (Vec3<T>& n : normals) n = {};
  for (const Triangle& t : triangles) {
    const Vec3<T>& a = positions[t[0]];
    const Vec3<T> n = cross(positions[t[1]] - a, positions[t[2]] - a);  // length: twice the area
    for (const std::uint32_t v : t) normals[v] += n;
  }
  for (Vec3<T>& n : normals) n = unit_normal(n);
}
std::vector<Vec3d> vertex_normals(const TriangleMesh& mesh);

}  // namespace souple
