#pragma once

#include "souple/fluid/fluid_view.h"
#include "souple/fluid/kernels/find_kernels.h"

#include <vector>

namespace souple {

/// Restores vorticity that a coarse fluid loses (Macklin and Müller 2013, equations 15 and 16):
///
///   omega_i = V sum_j grad W_ij x (v_j - v_i),   eta_i = V sum_j (|omega_j| - |omega_i|) grad W_ij
///   v_i <- v_i + h epsilon (eta / |eta|) x omega
///
/// It accelerates the rotation around vortex cores. epsilon is a speed [m/s]: a vortex of radius R and
/// angular velocity omega gains epsilon / R of its speed per second. It adds energy and does not conserve
/// momentum. Where |omega| is uniform, eta has no direction: gradients below a hundredth of |omega| per
/// spacing are damped.
class VorticityConfinement {
 public:
  explicit VorticityConfinement(SmoothingShape shape = SmoothingShape::wendland)
      : density_(&kernels::find_density_kernels(instruction_set(), shape)),
        velocity_(&kernels::find_velocity_kernels(instruction_set(), shape)) {}
  /// Updates v over h seconds.
  void apply(const FluidView& fluid, float epsilon, float h, Threads& threads);
  /// omega by sorted index, at the last apply [1/s].
  std::span<const Vec3f> vorticity() const { return omega_; }

 private:
  const kernels::DensityKernels* density_;
  const kernels::VelocityKernels* velocity_;
  std::vector<Vec3f> omega_;
  std::vector<Vec4f> strength_;  // x and |omega|; plus one extra record, far away
};

}  // namespace souple
