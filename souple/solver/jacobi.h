#pragma once

#include "souple/solver/chebyshev.h"
#include "souple/solver/linear_system.h"
#include "souple/solver/solver.h"

#include <vector>

namespace souple {

/// Jacobi: all constraints from the same positions, their corrections averaged at each particle.
///
/// A plain average divides what reaches particle i by the number n_i of its constraints; where n_i differs
/// between the particles of a constraint, its two ends then move by different impulses and momentum is lost.
/// So the mass is split instead (Tonge et al. 2012, "Mass splitting for jitter-free parallel rigid body
/// simulation"): each constraint has a particle of its own of mass m_i / n_i,
///
///   dlambda = b / (sum_i n_i w_i |grad_i C|^2 + A),    dx_i = omega 1/n_i sum (n_i w_i grad_i C dlambda)
///
/// which is the average where all n_i are equal, keeps momentum everywhere, and converges for every omega in
/// (0, 2) (`SolverSettings::relaxation`; 1.5 to 1.9 pays). Kinds without a linear form are projected after
/// each iteration, by Gauss-Seidel. With `SolverSettings::chebyshev` the iterations are accelerated as those
/// of GaussSeidel are.
class Jacobi final : public Solver {
 public:
  explicit Jacobi(const SolverSettings& settings)
      : relaxation_(static_cast<double>(settings.relaxation)), chebyshev_(settings.chebyshev) {}

  std::string_view name() const override { return "jacobi"; }
  void prepare(std::span<Projector* const> projectors, const ParticleView& particles) override;
  void solve(std::span<Projector* const> projectors, const ParticleView& particles, const Substep& substep,
             Threads& threads) override;

 private:
  void iterate(const ParticleView& particles, const Substep& substep);
  void count_constraints();
  void solve_block(const LinearSystem::Block& block);

  double relaxation_;
  Chebyshev chebyshev_;
  LinearSystem system_;
  std::vector<Projector*> others_;
  std::vector<double> split_;  // n_i w_i of each unknown
  Chebyshev::History<Vec4f> moving_;
  Chebyshev::History<double> multipliers_;
};

}  // namespace souple
