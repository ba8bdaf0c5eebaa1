#pragma once

#include "souple/geometry/tet_mesh.h"

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace souple {

/// Points embedded in a tet mesh: point i = sum_k weights[i][k] x[vertices[i][k]]; weights sum to 1.
struct Embedding {
  std::vector<Tet> vertices;                   ///< per point: the four vertices of its tet
  std::vector<std::array<double, 4>> weights;  ///< barycentric; some are negative for a point outside its tet
  std::vector<std::uint32_t> tets;             ///< per point: its tet
  std::size_t outside{};      ///< number of points in no tet; each is embedded in its nearest tet
  double largest_distance{};  ///< largest distance of an outside point to its tet [m]; 0 without such points
};

/// Embeds each point in the lowest-numbered tet that contains it, otherwise in the nearest tet, with extrapolated
/// weights. So any affine motion of the mesh moves all points exactly. Degenerate tets are not used. Throws Error if
/// all tets are degenerate, an index is out of range, or a point or used position is not finite.
Embedding embed(std::span<const Vec3d> points, const TetMesh& mesh);

/// Computes the embedded points for vertices at `mesh_positions` into `points`, one per embedded point.
/// Allocates nothing.
template <class T>
void apply(const Embedding& embedding, std::span<const Vec3<T>> mesh_positions, std::span<Vec3<T>> points) {
  for (std::size_t i = 0; i < embedding.vertices.size(); ++i) {
    const Tet& v = embedding.vertices[i];
    const std::array<double, 4>& w = embedding.weights[i];
    // As offsets from the first vertex, to keep precision far from the origin.
    const Vec3<T>& a = mesh_positions[v[0]];
    points[i] = a + ((mesh_positions[v[1]] - a) * T(w[1]) + (mesh_positions[v[2]] - a) * T(w[2]) +
                     (mesh_positions[v[3]] - a) * T(w[3]));
  }
}

}  // namespace souple
