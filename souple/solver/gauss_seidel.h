#pragma once

#include "souple/solver/solver.h"

namespace souple {

/// Nonlinear Gauss-Seidel, the seed's chapter 6 and Müller et al. 2007, section 3.4. It projects one constraint after
/// another, each from the positions that the previous ones left. Constraints of one color share no particle and are
/// projected at the same time. Substep::relaxation multiplies each correction and its multiplier (not contacts).
class GaussSeidel final : public Solver {
 public:
  std::string_view name() const override { return "gauss_seidel"; }
  using Solver::prepare;
  void prepare(std::span<Projector* const>, const ParticleView&) override {}
  void solve(std::span<Projector* const> projectors, const ParticleView& particles, const Substep& substep,
             Threads& threads) override;
};

}  // namespace souple
