#include "souple/surface/pseudonormals.h"

#include "souple/geometry/adjacency.h"
#include "souple/geometry/measures.h"
#include "souple/geometry/weld.h"

#include <cmath>
#include <utility>

namespace souple {

namespace {

/// Of length 1; zero where there is no area.
Vec3d normal_of(const std::array<Vec3d, 3>& x) {
  return unit_normal(cross(x[1] - x[0], x[2] - x[0]));
}

}  // namespace

Pseudonormals::Pseudonormals(std::vector<Vec3d> positions, std::span<const Triangle> triangles) {
  const Weld weld = weld_vertices(positions);
  triangles_ = weld_triangles(weld, triangles).triangles;
  positions_ = weld.is_identity() ? std::move(positions) : gather<Vec3d>(weld, positions);
  std::erase_if(triangles_, [&](const Triangle& t) {
    return normal_of({positions_[t[0]], positions_[t[1]], positions_[t[2]]}) == Vec3d{};
  });
  TriangleEdges edges = triangle_edges(triangles_);
  edges_of_triangle_ = std::move(edges.of_triangle);
  of_triangle_.resize(triangles_.size());
  of_edge_.resize(edges.edges.size());
  of_vertex_.resize(positions_.size());
  for (std::size_t t = 0; t < triangles_.size(); ++t) {
    const std::array<Vec3d, 3> x = corners(t);
    const Vec3d n = normal_of(x);
    of_triangle_[t] = n;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3d a = x[(k + 1) % 3] - x[k], b = x[(k + 2) % 3] - x[k];
      of_edge_[edges_of_triangle_[t][k]] += n;
      of_vertex_[triangles_[t][k]] += n * std::atan2(length(cross(a, b)), dot(a, b));
    }
  }
}

std::array<Vec3d, 3> Pseudonormals::corners(std::size_t triangle) const {
  const Triangle& t = triangles_[triangle];
  return {positions_[t[0]], positions_[t[1]], positions_[t[2]]};
}

Vec3d Pseudonormals::at(std::size_t triangle, const TrianglePoint& nearest) const {
  const std::array<double, 3> weight = {nearest.a, nearest.b, nearest.c};
  std::size_t zeros = 0, zero = 0, other = 0;  // the last weights that are 0, and are not
  for (std::size_t k = 0; k < 3; ++k) {
    if (weight[k] == 0) {
      ++zeros;
      zero = k;
    } else {
      other = k;
    }
  }
  if (zeros == 0) return of_triangle_[triangle];
  if (zeros == 1) return of_edge_[edges_of_triangle_[triangle][(zero + 1) % 3]];  // opposite of the corner
  return of_vertex_[triangles_[triangle][other]];
}

}  // namespace souple
