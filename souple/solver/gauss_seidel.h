#pragma once

#include "souple/solver/solver.h"

namespace souple {

/// Nonlinear Gauss-Seidel, the seed's chapter 6 and Müller et al. 2007, section 3.4: constraint after
/// constraint, each from where the ones before it left the particles. Those of a colour share no particle and
/// are projected at the same time.
class GaussSeidel final : public Solver {
 public:
  explicit GaussSeidel(const SolverSettings& settings) : settings_(settings) {}

  std::string_view name() const override { return "gauss_seidel"; }
  void prepare(std::span<Projector* const>, const ParticleView&) override {}
  void solve(std::span<Projector* const> projectors, const ParticleView& particles, const Substep& substep,
             Threads& threads) override;

 private:
  SolverSettings settings_;
};

}  // namespace souple
