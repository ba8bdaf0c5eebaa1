#include "souple/surface/mesh_smoothing.h"

#include "souple/geometry/measures.h"

#include <utility>

namespace souple {

void MeshSmoothing::smooth(SurfaceMesh& mesh, std::span<const float> weights, int passes, float factor,
                           Threads& threads) {
  // In a closed mesh each edge belongs to two triangles, once in each direction.
  neighbors_.fill(mesh.positions.size(), [&](const auto& add) {
    for (const Triangle& t : mesh.triangles)
      for (std::size_t k = 0; k < 3; ++k) add(t[k], t[(k + 1) % 3]);
  });
  before_.resize(mesh.positions.size());
  for (int pass = 0; pass < passes; ++pass) {
    std::swap(before_, mesh.positions);
    threads.each(before_.size(), 4096, [&](std::size_t v) {
      Vec3f sum;
      const std::span<const std::uint32_t> neighbors = std::as_const(neighbors_)[v];
      for (const std::uint32_t i : neighbors) sum += before_[i];
      const auto count = static_cast<float>(neighbors.size());
      mesh.positions[v] = before_[v] + (sum / count - before_[v]) * (factor * weights[v]);
    });
  }
  vertex_normals<float>(mesh.positions, mesh.triangles, mesh.normals);
}

}  // namespace souple
