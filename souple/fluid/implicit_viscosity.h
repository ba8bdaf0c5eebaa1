#pragma once

#include "souple/fluid/kernels/find_kernels.h"
#include "souple/fluid/xsph.h"

namespace souple {

/// Implicit viscosity of any strength. The velocities after the substep solve
///
///   v_i = v*_i + h w_i 10 V^2 sum_j mu_ij b (1 - r / h) (v_j - v_i) . d / (d^2 + 0.0001 h^2) d + walls
///
/// (Weiler et al. 2018, "A physically consistent implicit viscosity solver for SPH fluids", equation 8, with
/// mu_ij the harmonic mean). Forces between two particles act along their connecting line, so linear and
/// angular momentum are conserved, and a rotating drop keeps rotating. Instead of the paper's kernel slope we
/// use a linear weight, with b such that V sum_j b (1 - r / h) r^2 = 3 on the lattice. With Wendland's slope the
/// nearest neighbors have nearly all the weight. On a lattice, shear along an axis then decays at 0.6 of its rate and
/// along a diagonal at 1.6. With the linear weight the factors are 1.07 and 0.9.
///
/// Uses matrix-free conjugate gradients, warm-started from the current velocities. The preconditioner is the
/// mass alone. So each iteration adds a sum of pair forces, and momentum is exact even if iterations stop
/// early. Dot products sum over fixed chunks.
class ImplicitViscosity {
 public:
  struct Options {
    int max_iterations = 100;
    float tolerance = 0.01f;  ///< of the residual, relative to the initial residual
  };
  struct Report {
    int iterations = 0;
    float residual = 0;  ///< relative to the initial residual
  };
  ImplicitViscosity(SmoothingShape shape, const Options& options)
      : options_(options), kernels_(&kernels::find_velocity_kernels(instruction_set(), shape)) {}
  /// Updates v over h seconds.
  Report apply(const FluidView& fluid, WallFriction walls, float h, Threads& threads);

 private:
  /// Data of one substep for all iterations.
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
  std::vector<Vec4f> direction_;  // and mu; plus one extra record, far away
  std::vector<Vec3f> residual_, product_;
  std::vector<double> chunks_;
};

}  // namespace souple
