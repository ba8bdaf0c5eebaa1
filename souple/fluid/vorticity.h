#pragma once

#include "souple/fluid/fluid_view.h"

#include <vector>

namespace souple {

/// Gives back some of the whirls that a coarse fluid loses (Macklin and Müller 2013, equations 15 and 16):
///
///   omega_i = V sum_j grad W_ij x (v_j - v_i),   eta_i = V sum_j (|omega_j| - |omega_i|) grad W_ij
///   v_i <- v_i + h epsilon (eta / |eta|) x omega
///
/// It drives a flow along around where it turns fastest. epsilon is a speed [m/s]: where a whirl of radius R
/// turns at omega, the flow gains epsilon / R of its speed each second. It adds energy, and momentum is not
/// kept. Where |omega| is the same all around, eta has no direction: what is less than a hundredth of |omega|
/// in a spacing counts less and less.
class VorticityConfinement {
 public:
  explicit VorticityConfinement(SmoothingShape shape = SmoothingShape::wendland)
      : density_(&kernels::find_density_kernels(instruction_set(), shape)),
        velocity_(&kernels::find_velocity_kernels(instruction_set(), shape)) {}
  /// Changes v over h seconds.
  void apply(const FluidView& fluid, float epsilon, float h, Threads& threads);
  /// omega by place, of the last look [1/s].
  std::span<const Vec3f> vorticity() const { return omega_; }

 private:
  const kernels::DensityKernels* density_;
  const kernels::VelocityKernels* velocity_;
  std::vector<Vec3f> omega_;
  std::vector<Vec4f> strength_;  // where, and |omega|; one more, far away
};

}  // namespace souple
