#pragma once

#include "souple/solver/linearized_solver.h"

#include <memory>

namespace souple {

/// The global system by a sparse Cholesky factorization L D L^T (Eigen's, ordered by approximate minimum
/// degree), its pattern analyzed once in `prepare`, its numbers factorized in every iteration.
///
/// - primal where every row has compliance, or where rigid rows outnumber the unknowns (a cloth): 3 unknowns
///   per free particle. Rigid rows then get the floor of linear_system.h, and `remark` says so;
/// - dual where rigid rows do not outnumber the unknowns (ropes, chains): exact, but for a billionth of its
///   diagonal that keeps redundant rows from dividing by zero.
///
/// Eigen allocates in every iteration.
class Direct final : public LinearizedSolver {
 public:
  Direct();
  ~Direct() override;
  std::string_view name() const override { return "direct"; }
  std::string diagnostic() const override;

 protected:
  /// Throws Error where a factorization would take more than about a second.
  void prepare_system(LinearSystem& system, const ParticleView& particles) override;
  bool solve_system(LinearSystem& system, Threads& threads) override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace souple
