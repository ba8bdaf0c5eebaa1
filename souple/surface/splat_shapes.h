#pragma once

#include "souple/math/mat3.h"
#include "souple/surface/particle_kernels.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace souple {

/// Ellipsoids for drawing the particles of a fluid. Together they look like its surface: flat where the fluid
/// is flat, not beaded. The points of ellipsoid i are
///
///   x = c_i + A_i u, |u| <= 1,   c_i = center_i - shift_i,   A_i = f G_i^-1
///
/// with the center, shift and G of the particle's kernel, as for the mesh (particle_kernels.h; Yu and Turk
/// 2013). Centers are smoothed, then moved back by the mean shift of those around them. f is chosen so that
/// the surface of a pool is d / 2 above its topmost particles. A particle with few neighbors is a ball of its
/// own volume. A particle with neighbors all around is invisible and has A = 0.
///
/// Results are equal, bit by bit, for any number of threads and with all instruction sets.
class SplatShapes {
 public:
  /// `spacing`: d, distance of particles at rest [m]. Throws Error where it is not above 0.
  explicit SplatShapes(float spacing);

  /// Computes the ellipsoids of these particles [m]; they are valid until the next call. Particles whose
  /// position is not finite, or further from the origin than 2^18 times 2.5 d along an axis, keep their
  /// position and have A = 0. Allocates nothing when warm.
  void build(std::span<const Vec3f> positions, Threads& threads);

  float spacing() const { return options_.spacing; }
  /// Per particle: center and A [m].
  std::span<const Vec3f> centers() const { return centers_; }
  std::span<const Mat3f> axes() const { return axes_; }

 private:
  Mat3f axes_at(std::size_t sorted_index, std::size_t neighbors) const;

  SurfaceOptions options_;
  CellOrder order_;
  Neighbors neighbors_;
  ParticleKernels particles_;
  std::vector<Vec4f> positions_;         // of particles that have a shape [m]
  std::vector<std::uint32_t> particle_;  // their indices
  std::vector<Vec3f> centers_;
  std::vector<Mat3f> axes_;
};

}  // namespace souple
