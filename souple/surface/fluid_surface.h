#pragma once

#include "souple/surface/marching_cubes.h"
#include "souple/surface/mesh_smoothing.h"
#include "souple/surface/surface_options.h"

#include <span>
#include <vector>

namespace souple {

/// What building a surface took. [ms]
struct SurfaceTimes {
  double sort = 0, neighbors = 0, kernels = 0, field = 0, mesh = 0, smoothing = 0;
  double all() const { return sort + neighbors + kernels + field + mesh + smoothing; }
};

/// The surface of a fluid's particles as a closed mesh without seams, after
///
///   Yu and Turk 2013, "Reconstructing surfaces of particle-based fluids using anisotropic kernels"
///
/// The field is a sum of kernels, one a particle, each stretched as its neighbors lie (particle_kernels.h);
/// it is evaluated near the surface only (surface_field.h), and the mesh is cut out of it (marching_cubes.h).
///
/// Where we deviate: the paper moves kernels' centers towards the mean of their neighbors, which calms the
/// surface, and draws it in by half a spacing and more: a ball of 20 spacings would lose a fifth of its
/// volume. Here each vertex goes back the way that the centers around it went, averaged with their weights in
/// the field. Nor are centers of particles with few neighbors moved as far: two would become one.
///
/// The same mesh, bit by bit, for any number of threads and with all instruction sets.
class FluidSurface {
 public:
  /// Throws Error, naming the option, where one makes no sense.
  explicit FluidSurface(const SurfaceOptions& options);

  /// The mesh of these particles [m], valid until the next call. Positions that are not finite, or further
  /// than 250,000 neighbor radii from the origin, are left out. Allocates nothing when warm.
  const SurfaceMesh& build(std::span<const Vec3f> positions, Threads& threads);

  const SurfaceMesh& mesh() const { return mesh_; }
  const SurfaceTimes& times() const { return times_; }
  /// With what was found where 0 was given.
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
  SurfaceTimes times_;
  std::vector<Vec4f> positions_;
};

}  // namespace souple
