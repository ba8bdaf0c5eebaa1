#pragma once

#include "souple/surface/marching_cubes.h"
#include "souple/surface/mesh_smoothing.h"
#include "souple/surface/surface_options.h"

#include <span>
#include <vector>

namespace souple {

/// The surface of a fluid's particles as a closed mesh without seams. Source:
///
///   Yu and Turk 2013, "Reconstructing surfaces of particle-based fluids using anisotropic kernels"
///
/// The field is a sum of kernels, one per particle, each stretched by the distribution of its neighbors
/// (particle_kernels.h). It is evaluated near the surface only (surface_field.h). Marching cubes extracts the
/// mesh (marching_cubes.h).
///
/// Deviations: the paper moves the centers of kernels towards the mean of their neighbors. This smooths the surface but
/// moves it inwards by half a spacing or more. A ball of 20 spacings would lose a fifth of its volume. Here each vertex
/// is moved back by the mean shift of the centers around it, weighted by their kernels in the field. Centers of
/// particles with few neighbors are moved less: two of them would become one.
///
/// The mesh is equal, bit by bit, for any number of threads and with all instruction sets.
class FluidSurface {
 public:
  /// Throws Error where an option is out of its range; the message names it.
  explicit FluidSurface(const SurfaceOptions& options);

  /// The mesh of these particles [m], valid until the next call. Ignores positions that are not finite, or further from
  /// the origin than 2^18 times the smaller of the neighbor radius and four cells. Allocates nothing when warm.
  const SurfaceMesh& build(std::span<const Vec3f> positions, Threads& threads);

  const SurfaceMesh& mesh() const { return mesh_; }
  /// The options, with computed values in place of 0.
  const SurfaceOptions& options() const { return options_; }

 private:
  SurfaceOptions options_;
  CellOrder order_;
  Neighbors neighbors_;
  ParticleKernels particles_;
  SurfaceField field_;
  MarchingCubes cubes_;
  MeshSmoothing smoothing_;
  SurfaceMesh mesh_;
  std::vector<Vec4f> positions_;
};

}  // namespace souple
