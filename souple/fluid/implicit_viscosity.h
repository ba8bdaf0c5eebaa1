#pragma once

#include "souple/fluid/xsph.h"

namespace souple {

/// Viscosity of any strength: the velocities after the substep solve
///
///   v_i = v*_i + h w_i 10 V^2 sum_j mu_ij b (1 - r / h) (v_j - v_i) . d / (d^2 + 0.0001 h^2) d + walls
///
/// (Weiler et al. 2018, "A physically consistent implicit viscosity solver for SPH fluids", equation 8, with
/// mu_ij the harmonic mean). Forces between two particles lie along the line between them: linear and angular
/// momentum stay, and a drop that turns as a whole goes on turning. Where the paper has the slope of the
/// smoothing kernel, a straight line stands for it, with b such that V sum_j b (1 - r / h) r^2 = 3 on the
/// lattice: with Wendland's slope the nearest neighbors have nearly all the weight, and on a lattice shear
/// along an axis decays at 0.6 of its rate, along a diagonal at 1.6 (1.07 and 0.9 with the line).
///
/// Conjugate gradients without a matrix, from the velocities as they are. The preconditioner is the mass
/// alone: so what the iterations add is, in each of them, a sum of forces between pairs, and momentum is
/// exact however early they stop. Dot products are sums of fixed chunks.
class ImplicitViscosity {
 public:
  struct Options {
    int max_iterations = 100;
    float tolerance = 0.01f;  ///< of the residual, over what it is before the first iteration
  };
  struct Report {
    int iterations = 0;
    float residual = 0;  ///< over what it was before the first iteration
  };
  ImplicitViscosity(SmoothingShape shape, const Options& options)
      : options_(options), kernels_(&kernels::find_velocity_kernels(instruction_set(), shape)) {}
  /// Changes v over h seconds.
  Report apply(const FluidView& fluid, WallFriction walls, float h, Threads& threads);

 private:
  /// What iterations know of a substep.
  struct System {
    const FluidView& fluid;
    WallFriction walls;
    float h;
    Threads& threads;
  };
  Vec3f force(const System& system, std::span<const Vec4f> values, std::uint32_t index,
              std::span<const std::uint32_t> list) const;
  float wall_drag(const System& system, std::size_t index) const;
  void begin(const System& system);
  void apply_matrix(const System& system);
  template <class Term>
  double sum(const System& system, const Term& term);

  Options options_;
  const kernels::VelocityKernels* kernels_;
  std::vector<Vec4f> direction_;  // and mu; one more, far away
  std::vector<Vec3f> residual_, product_;
  std::vector<double> chunks_;
};

}  // namespace souple
