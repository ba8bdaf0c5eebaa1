#pragma once

#include "souple/geometry/tet_mesh.h"

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace souple {

/// Points carried by a tet mesh: point i = sum_k weights[i][k] x[vertices[i][k]], weights summing to 1.
struct Embedding {
  std::vector<Tet> vertices;                   ///< per point: the four tet-mesh vertices that carry it
  std::vector<std::array<double, 4>> weights;  ///< barycentric; some negative for a point outside its tet
  std::vector<std::uint32_t> tets;             ///< per point: the tet
  std::size_t outside{};                       ///< points that lie in no tet, and hang on the nearest one
  double largest_distance{};                   ///< meters, of those points to their tet; 0 if there are none
};

/// Embeds each point in the lowest-numbered tet that contains it, or else in the nearest one, whose weights
/// are then extrapolated, so that any affine motion of the mesh moves the points exactly. Tets of no volume
/// are not used. Throws Error if the mesh has no tet with a volume, an index is out of range, or a point or
/// used position is not finite.
Embedding embed(std::span<const Vec3d> points, const TetMesh& mesh);

/// Where the embedded points are when the mesh's vertices are at `mesh_positions`; fills `points`, one per
/// embedded point. Allocates nothing.
template <class T>
void apply(const Embedding& embedding, std::span<const Vec3<T>> mesh_positions, std::span<Vec3<T>> points) {
  for (std::size_t i = 0; i < embedding.vertices.size(); ++i) {
    const Tet& v = embedding.vertices[i];
    const std::array<double, 4>& w = embedding.weights[i];
    // As offsets from the first vertex: a body far from the origin keeps its digits.
    const Vec3<T>& a = mesh_positions[v[0]];
    points[i] = a + ((mesh_positions[v[1]] - a) * T(w[1]) + (mesh_positions[v[2]] - a) * T(w[2]) +
                     (mesh_positions[v[3]] - a) * T(w[3]));
  }
}

}  // namespace souple
