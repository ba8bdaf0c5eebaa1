#pragma once

#include "souple/studies/linearized_solver.h"

#include <memory>

namespace souple {

/// The seed's classical method: the dual system (J W J^T + A) dlambda = b as a dense matrix, solved by the
/// pseudo-inverse from its singular values. Redundant and contradictory constraints are satisfied in the
/// least-squares sense. Cost: cubic in the number of rows, at most 600. The tests use it as the reference
/// solution.
class Dense final : public LinearizedSolver {
 public:
  static constexpr std::size_t max_rows = 600;

  Dense();
  ~Dense() override;
  std::string_view name() const override { return "dense"; }
  std::string diagnostic() const override { return floor_diagnostic(); }

 protected:
  void prepare_system(LinearSystem& system, const ParticleView& particles) override;
  bool solve_system(LinearSystem& system, Threads& threads) override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace souple
