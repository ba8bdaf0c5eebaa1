#pragma once

#include "souple/studies/linearized_solver.h"

#include <memory>

namespace souple {

/// Solves the global system by a sparse Cholesky factorization L D L^T (Eigen's, ordered by approximate
/// minimum degree). `prepare` analyzes the pattern once; every iteration factorizes the numbers.
///
/// - primal if no row needs the floor of linear_system.h, that is every row has compliance. Also if the rows outnumber
///   the unknowns, 3 per free particle, as in a cloth. Rigid rows then get the floor, and `diagnostic` reports it;
///   Rigid rows then get the floor, and `diagnostic` reports it;
/// - dual if a row is rigid and the rows do not outnumber the unknowns (ropes, chains). It is exact, except that a
///   billionth of the diagonal is added so that redundant rows do not divide by zero.
///
/// Eigen allocates in every iteration.
class Direct final : public LinearizedSolver {
 public:
  Direct();
  ~Direct() override;
  std::string_view name() const override { return "direct"; }
  std::string diagnostic() const override;

 protected:
  /// Throws Error when the system has too many unknowns or entries, or a factorization would take more than
  /// some seconds (5e9 multiplications).
  void prepare_system(LinearSystem& system, const ParticleView& particles) override;
  bool solve_system(LinearSystem& system, Threads& threads) override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace souple
