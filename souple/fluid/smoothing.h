#pragma once

#include "souple/fluid/kernels/density_kernels.h"
#include "souple/fluid/smoothing_shape.h"

#include <array>

namespace souple {

/// The smoothing kernel of a fluid with rest spacing d and support h = 2 d (2.3 d for wide_wendland), and the
/// contribution of walls. With V = d^3 its factors satisfy, on the cubic lattice of this spacing,
///
///   V sum_j W(r_ij)                              = 1, the particle itself included
///   V sum_j grad W(r_ij) . (x_j - x_i)           = 3 g
///
/// These sums differ from the integrals by one percent or more. With factors from the integrals a fluid would rest too
/// high or too low by that much. g is 1.04: particles at rest are not on a lattice, and with g = 1 pressures would be 4
/// % too high. Other shapes have their own measured factors.
class Smoothing {
 public:
  /// `spacing` > 0 [m].
  explicit Smoothing(float spacing, SmoothingShape shape = SmoothingShape::wendland);

  float spacing() const { return spacing_; }
  float support() const { return factors_.h; }
  float volume() const { return spacing_ * spacing_ * spacing_; }  ///< V [m^3]
  const kernels::SmoothingFactors& factors() const { return factors_; }
  float center() const { return center_; }  ///< W(0) [1/m^3]

  /// A wall's contribution to V sum W, and its derivative along the normal that points away from the wall
  /// [1/m].
  struct Wall {
    float value, slope;
  };
  /// Contribution of a plane wall at a distance [m], which may be negative. The fluid behind the wall is the
  /// mirror image of the fluid in front and moves with it. So with H the half-space behind a plane
  ///
  ///   value(s) = H(d/2 + a (s - d/2)),   slope(s) = a H'(d/2 + a (s - d/2)),   a = 2
  ///
  /// (2.2 for poly6 and the cubic spline, 2.4 for the wide kernel), H(-z) = 2 H(0) - H(z). The work of a push
  /// by lambda slope then equals the gain in value. A push that also counted the fluid behind would stir the
  /// fluid forever. H and H' are scaled such that a lattice layer at d/2 has density 1 and that equal
  /// pressures do not push it.
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
