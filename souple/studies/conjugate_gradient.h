#pragma once

#include "souple/studies/linearized_solver.h"

#include <vector>

namespace souple {

/// Solves the primal system (M + J^T A^-1 J) dx = J^T A^-1 b by conjugate gradients preconditioned by M: no
/// matrix, no factorization, any size. Rigid rows get the floor of linear_system.h.
///
/// With this preconditioner every iterate has the form W J^T y. The iteration stops at a residual of
/// `tolerance` times the first, or after `max_products` products with the matrix. An iterate that stops early
/// still consists of constraint forces: momentum and angular momentum are those of the exact solution, and
/// unconstrained motion stays free. The remaining error is stretch. `diagnostic` reports the residual
/// reached.
///
/// Rejected: the inverse of each particle's 3 x 3 block as preconditioner. It gains nothing on meshes of similar
/// elements. Stopped early, it brakes swinging motion: a hanging 50 x 50 cloth fell with two thirds of its energy. Also
/// rejected: the multipliers of the previous substep as a start. They gave twice the strain on that cloth: the Krylov
/// space from zero finds them at once, and the restart spoils it.
///
/// Bitwise equal for any number of threads. Allocates nothing in a warm step.
class ConjugateGradient final : public LinearizedSolver {
 public:
  /// Limit for this many particles: 1.5 times the side of a square of them, at least 50. A correction crosses
  /// one constraint per product, so a large mesh needs more products.
  static int max_products(std::size_t particles);
  static constexpr double tolerance = 1e-4;

  std::string_view name() const override { return "conjugate_gradient"; }
  std::string diagnostic() const override;

 protected:
  void prepare_system(LinearSystem& system, const ParticleView& particles) override;
  bool solve_system(LinearSystem& system, Threads& threads) override;

 private:
  /// The gradient of a row at one of its free particles.
  struct Entry {
    std::uint32_t row;
    Vec3f gradient;
  };
  /// Coefficients of the previous step, applied in the next product: dx += alpha direction, direction = W
  /// residual + beta direction.
  struct StepCoefficients {
    double alpha = 0, beta = 0;
  };

  void gather_entries(const LinearSystem& system, Threads& threads);
  void begin(LinearSystem& system, Threads& threads);
  void multiply(LinearSystem& system, const StepCoefficients& last, Threads& threads);
  Vec3d constraint_force(std::size_t unknown) const;
  template <class Term>
  double sum(Threads& threads, const Term& term);

  std::vector<std::uint32_t> entry_begin_;  // per unknown: begin of its entries; then the end
  std::vector<std::uint32_t> gradient_of_;  // per entry: its index in LinearSystem::gradient
  std::vector<Entry> entries_;
  // Vectors of the form W J^T y or J^T y are kept in both spaces: dx = W J^T dlambda, residual = J^T
  // row_residual, direction = W J^T row_direction.
  std::vector<double> row_residual_, row_direction_, force_;  // force = A^-1 J direction
  std::vector<Vec3d> residual_, direction_, product_;
  std::vector<double> partial_;  // partial sums, per chunk
  // products_, reached_: of the last system; max_products_used_, worst_: maximum since `prepare`.
  int products_ = 0, max_products_used_ = 0;
  double reached_ = 0, worst_ = 0;
};

}  // namespace souple
