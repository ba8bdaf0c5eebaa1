#pragma once

#include "souple/math/mat3.h"
#include "souple/solver/linearised_solver.h"
#include "souple/solver/rigid_motion.h"

#include <vector>

namespace souple {

/// The primal system (M + J^T A^-1 J) dx = J^T A^-1 b by preconditioned conjugate gradients: no matrix, no
/// factorisation, any size. The preconditioner is the inverse of the 3 x 3 block of each particle. Rigid rows
/// get the floor of linear_system.h.
///
/// An iteration stops at a residual (in the preconditioner's norm) of `tolerance` times the first, or after
/// `most_products` products with the matrix; `remark` tells how far it came. What it has then is a descent
/// direction all the same: too soft a cloth, never a wrong one. What momentum it then has is taken out
/// (rigid_motion.h). Bitwise equal for any number of threads. Allocates nothing in a warm step.
class ConjugateGradient final : public LinearisedSolver {
 public:
  static constexpr int most_products = 300;
  static constexpr double tolerance = 1e-6;

  std::string_view name() const override { return "conjugate_gradient"; }
  std::string remark() const override;

 protected:
  void prepare_system(LinearSystem& system, const ParticleView& particles) override;
  bool solve_system(LinearSystem& system, const ParticleView& particles, Threads& threads) override;

 private:
  /// Member `member` of a block has an unknown.
  struct Incidence {
    std::uint32_t block, member;
  };

  void build_preconditioner(const LinearSystem& system, Threads& threads);
  void build_right_side(const LinearSystem& system, Threads& threads);
  void multiply(const LinearSystem& system, Threads& threads);
  double precondition(Threads& threads);
  template <class Term>
  double sum(Threads& threads, const Term& term);

  std::vector<std::uint32_t> incidence_begin_;  // of each unknown, and the end
  std::vector<Incidence> incidences_;
  std::vector<Mat3d> preconditioner_;
  std::vector<double> force_;  // per row: A^-1 J p
  std::vector<Vec3d> residual_, direction_, product_, preconditioned_;
  RigidMotion rigid_;
  std::vector<double> partial_;  // sums, per chunk
  // Of the last system, and the largest since `prepare`.
  int products_ = 0, most_used_ = 0;
  double reached_ = 0, worst_ = 0;
};

}  // namespace souple
