#pragma once

#include "souple/fluid/kernels/density_kernels.h"

#include <array>

namespace souple {

/// The kernels of a fluid whose particles lie on a lattice of a spacing at rest, support h. Factors are such
/// that on that cubic lattice
///
///   V sum_j W(r_ij) = 1, the particle itself included, and
///   V sum_j grad W(r_ij) . (x_j - x_i) = 3   (what linear functions ask for)
///
/// with V = spacing^3: discrete sums differ from the integrals by a per cent or more, and a fluid at rest would
/// be too high by as much.
class Smoothing {
 public:
  /// Both > 0 [m].
  Smoothing(float spacing, float support);

  float spacing() const { return spacing_; }
  float support() const { return factors_.h; }
  float volume() const { return spacing_ * spacing_ * spacing_; }  ///< of a particle [m^3]
  const kernels::SmoothingFactors& factors() const { return factors_; }
  /// W(0). [1/m^3]
  float centre() const;

  /// What a half-space filled with particles adds to the density of one that is `distance` away from it: 0
  /// to 1, and its derivative along the normal that points away from it [1/m]. Distances below 0 count as 0.
  struct Wall {
    float density, slope;
  };
  Wall wall(float distance) const;

 private:
  static constexpr std::size_t wall_steps = 64;

  float spacing_;
  kernels::SmoothingFactors factors_;
  std::array<Wall, wall_steps + 2> wall_{};
};

}  // namespace souple
