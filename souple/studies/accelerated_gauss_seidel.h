#pragma once

#include "souple/studies/chebyshev.h"

namespace souple {

/// GaussSeidel with, alone or together,
/// - symmetric sweeps: all colors forward, then backward. Kinds without a linear form (contacts, shape
///   matching, enclosed volumes, custom constraints) follow once, so that contacts come last;
/// - Chebyshev acceleration of the sweeps.
class AcceleratedGaussSeidel final : public AcceleratedSolver {
 public:
  explicit AcceleratedGaussSeidel(const SolverSettings& settings)
      : AcceleratedSolver(settings.chebyshev), sweep_(settings.sweep) {}

  std::string_view name() const override { return "gauss_seidel"; }

 private:
  void iterate(std::span<Projector* const> projectors, const ParticleView& particles, const Substep& substep,
               Threads& threads) override;

  Sweep sweep_;
};

}  // namespace souple
