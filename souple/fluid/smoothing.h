#pragma once

#include "souple/fluid/kernels/density_kernels.h"
#include "souple/fluid/kernels/find_kernels.h"

#include <array>

namespace souple {

/// The smoothing kernel of a fluid whose particles lie d = spacing apart at rest, support h = 2 d (2.3 d
/// the wide one), and what a wall adds to it. With V = d^3, factors are such that on the cubic lattice of
/// that spacing
///
///   V sum_j W(r_ij)                              = 1, the particle itself included
///   V sum_j grad W(r_ij) . (x_j - x_i)           = 3 g
///
/// Sums differ from the integrals by a per cent or more, and a fluid would rest that much too high or too
/// low. g is 1.04: at rest particles do not lie on a lattice, and pressures would read 4 % too high with 1.
/// Other shapes have factors of their own, as measured.
class Smoothing {
 public:
  /// > 0 [m].
  explicit Smoothing(float spacing, SmoothingShape shape = SmoothingShape::wendland);

  float spacing() const { return spacing_; }
  float support() const { return factors_.h; }
  float volume() const { return spacing_ * spacing_ * spacing_; }  ///< V [m^3]
  const kernels::SmoothingFactors& factors() const { return factors_; }
  float center() const { return center_; }  ///< W(0) [1/m^3]

  /// What a wall adds to V sum W, and its derivative along the normal that points away from it [1/m].
  struct Wall {
    float value, slope;
  };
  /// Of a plane wall at a distance [m], also below 0. The fluid behind the wall is the mirror image of that
  /// before it and moves as that does, so with H the half-space behind a plane
  ///
  ///   value(s) = H(d/2 + a (s - d/2)),   slope(s) = a H'(d/2 + a (s - d/2)),   a = 2
  ///
  /// (2.2 for poly6 and the cubic spline, 2.4 for the wide one), H(-z) = 2 H(0) - H(z). A push by lambda
  /// slope then does as much work as the value gains: one that counts twice, for the fluid behind, stirs the
  /// fluid for ever. H and H' are scaled such that a layer of the lattice at d/2 has density 1, and that
  /// equal pressures do not push it.
  Wall wall(float distance) const;

 private:
  static constexpr int wall_steps = 128;

  float spacing_;
  float center_ = 0;
  float mirror_ = 2;  // a
  kernels::SmoothingFactors factors_;
  std::array<Wall, wall_steps + 2> half_space_{};  // H and H' at z = k h / wall_steps
};

}  // namespace souple
