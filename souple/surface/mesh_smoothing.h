#pragma once

#include "souple/math/lists.h"
#include "souple/surface/marching_cubes.h"

#include <span>
#include <vector>

namespace souple {

/// Laplacian smoothing of a closed mesh: each pass moves a vertex towards the mean of its neighbors along
/// edges,
///
///   x += factor weight (mean - x)
///
/// Weights of 0 keep drops from shrinking to nothing (Löschner et al. 2023, "Weighted Laplacian smoothing for
/// surface reconstruction of particle-based fluids").
class MeshSmoothing {
 public:
  /// `weights`: one per vertex, in [0, 1]. Recomputes the normals. Allocates nothing when warm.
  void smooth(SurfaceMesh& mesh, std::span<const float> weights, int passes, float factor, Threads& threads);

 private:
  Lists<std::uint32_t> neighbors_;  // per vertex
  std::vector<Vec3f> before_;
};

}  // namespace souple
