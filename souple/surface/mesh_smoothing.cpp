#include "souple/surface/mesh_smoothing.h"

#include "souple/geometry/measures.h"

#include <utility>

namespace souple {

// In a closed mesh each edge belongs to two triangles, once in each direction.
void MeshSmoothing::find_neighbors(const SurfaceMesh& mesh) {
  first_.assign(mesh.positions.size() + 1, 0);
  neighbor_.resize(3 * mesh.triangles.size());
  for (const Triangle& t : mesh.triangles)
    for (const std::uint32_t v : t) ++first_[v];
  std::uint32_t sum = 0;
  for (std::uint32_t& first : first_) sum += std::exchange(first, sum);
  // After the fill, first_[v] is the end of vertex v, which is the begin of the next: shift all by one.
  for (const Triangle& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) neighbor_[first_[t[k]]++] = t[(k + 1) % 3];
  for (std::size_t v = mesh.positions.size(); v > 0; --v) first_[v] = first_[v - 1];
  first_[0] = 0;
}

void MeshSmoothing::smooth(SurfaceMesh& mesh, std::span<const float> weights, int passes, float factor,
                           Threads& threads) {
  find_neighbors(mesh);
  before_.resize(mesh.positions.size());
  for (int pass = 0; pass < passes; ++pass) {
    std::swap(before_, mesh.positions);
    threads.each(before_.size(), 4096, [&](std::size_t v) {
      Vec3f sum;
      for (std::uint32_t k = first_[v]; k < first_[v + 1]; ++k) sum += before_[neighbor_[k]];
      const auto count = static_cast<float>(first_[v + 1] - first_[v]);
      mesh.positions[v] = before_[v] + (sum / count - before_[v]) * (factor * weights[v]);
    });
  }
  vertex_normals<float>(mesh.positions, mesh.triangles, mesh.normals);
}

}  // namespace souple
