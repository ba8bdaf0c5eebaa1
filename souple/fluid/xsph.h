#pragma once

#include "souple/fluid/fluid_view.h"
#include "souple/fluid/kernels/find_kernels.h"

#include <vector>

namespace souple {

/// By sorted index: friction with walls. xyz: wall velocity [m/s]; w: value of Smoothing::wall there, reduced
/// if the fluid may slip, 0 without a wall. Empty: no walls.
using WallFriction = std::span<const Vec4f>;

/// Friction coefficient of a wall at rest [1/m^2]: the force on a particle is V mu times this times the
/// velocity difference. The layer at d/2 from the wall has the stress mu v / (d/2) over d^2:
///
///   2 / d^2 value / value(d/2)
float wall_friction(const Smoothing& smoothing, float value);

/// Viscosity as an exchange of velocities between neighbors (Schechter and Bridson 2012, "Ghost SPH", section
/// 5; Macklin and Müller 2013, equation 17):
///
///   v_i <- v_i + h w_i (6 / m2) V^2 sum_j mu_ij W_ij (v_j - v_i),    m2 = V sum_j W_ij r_ij^2
///
/// with mu_ij the harmonic mean of the two viscosities. The paper's strength c is 6 h mu w V / m2. So a shear wave
/// sin(k x) decays at the rate nu k^2, nu = mu / rho, for any h. Momentum is conserved in pairs. The method is
/// explicit, stable for h nu / d^2 up to about 0.2. Walls are implicit.
class Xsph {
 public:
  explicit Xsph(SmoothingShape shape) : kernels_(&kernels::find_velocity_kernels(instruction_set(), shape)) {}
  /// Updates v over h seconds.
  void apply(const FluidView& fluid, WallFriction walls, float h, Threads& threads);

 private:
  const kernels::VelocityKernels* kernels_;
  std::vector<Vec3f> next_;
};

}  // namespace souple
