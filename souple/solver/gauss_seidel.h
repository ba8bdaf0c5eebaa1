#pragma once

#include "souple/solver/chebyshev.h"
#include "souple/solver/solver.h"

#include <vector>

namespace souple {

/// Nonlinear Gauss-Seidel, the seed's chapter 6 and Müller et al. 2007, section 3.4: projects one constraint
/// after another, each from the positions that the previous ones left. Constraints of one color share no
/// particle and are projected at the same time.
///
/// `SolverSettings` may add, alone or together:
/// - relaxation: multiplies each correction and its multiplier by omega (not contacts);
/// - symmetric sweeps: all colors forward, then backward. Kinds without a linear form (contacts, shape
///   matching, enclosed volumes, custom constraints) follow once, so that contacts come last;
/// - Chebyshev acceleration of the sweeps, from the third iteration of a substep on. It is off in substeps
///   in which a kind without a linear form has constraints: an extrapolated contact bounces.
class GaussSeidel final : public Solver {
 public:
  explicit GaussSeidel(const SolverSettings& settings)
      : settings_(settings), chebyshev_(settings.chebyshev) {}

  std::string_view name() const override { return "gauss_seidel"; }
  void prepare(std::span<Projector* const> projectors, const ParticleView& particles) override;
  void solve(std::span<Projector* const> projectors, const ParticleView& particles, const Substep& substep,
             Threads& threads) override;

 private:
  void sweep_symmetric(const ParticleView& particles, const Substep& substep, Threads& threads);

  SolverSettings settings_;
  Chebyshev chebyshev_;
  // With and without a linear form; only for symmetric sweeps or Chebyshev.
  std::vector<Projector*> linear_, others_;
};

}  // namespace souple
