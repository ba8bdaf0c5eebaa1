#pragma once

#include "souple/math/mat3.h"
#include "souple/surface/particle_kernels.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace souple {

/// The particles of a fluid as ellipsoids to be drawn, so that together they look like its surface: flat
/// where the fluid is, not beaded. The points of ellipsoid i are
///
///   x = c_i + A_i u, |u| <= 1,   c_i = center_i - shift_i,   A_i = f G_i^-1
///
/// with the center, its shift and G of a kernel as the mesh has them (particle_kernels.h; Yu and Turk 2013).
/// Centers are smoothed and brought back by what those around them went; f is such that the surface of a
/// pool lies d / 2 above its topmost particles. With few neighbors a particle is a ball of its own volume;
/// with others all around it is not seen, and has A = 0.
///
/// The same bits for any number of threads and with all instruction sets.
class SplatShapes {
 public:
  /// `spacing` of particles at rest, d [m]. Throws Error where it is not above 0.
  explicit SplatShapes(float spacing);

  /// Of these particles [m], valid until the next call. What is not finite, or further than 250,000 times
  /// 2.5 d from the origin, stays where it is and has A = 0. Allocates nothing when warm.
  void build(std::span<const Vec3f> positions, Threads& threads);

  float spacing() const { return options_.spacing; }
  /// By particle [m].
  std::span<const Vec3f> centers() const { return centers_; }
  std::span<const Mat3f> axes() const { return axes_; }

 private:
  Mat3f axes_at(std::size_t sorted_index, std::size_t neighbors) const;

  SurfaceOptions options_;
  CellOrder order_;
  Neighbors neighbors_;
  ParticleKernels particles_;
  std::vector<Vec4f> positions_;         // of those that have a shape
  std::vector<std::uint32_t> particle_;  // which these are
  std::vector<Vec3f> centers_;
  std::vector<Mat3f> axes_;
};

}  // namespace souple
