#pragma once

#include "souple/solver/solver.h"
#include "souple/studies/linear_system.h"

#include <vector>

namespace souple {

/// Base of the solvers of the global system. Each iteration linearizes all constraints at the current
/// positions (linear_system.h), solves the system, and moves the particles by the solution or a part of it.
/// Gauss-Seidel projects kinds without a linear form (contacts, shape matching, enclosed volumes, custom
/// constraints) after each iteration.
///
/// The linearization is valid only near the positions at which it was made; in the folds of a rigid cloth it
/// is useless. So a displacement may deform a constraint by at most half its size. It is halved until it does
/// not increase
///
///   1/2 b^T A^-1 b + 1/2 dx^T M dx
///
/// (b is computed again after the displacement): the function that the linear system minimizes. After four
/// halvings it is accepted unchecked.
class LinearizedSolver : public Solver {
 public:
  void prepare(std::span<Projector* const> projectors, const ParticleView& particles) final;
  void solve(std::span<Projector* const> projectors, const ParticleView& particles, const Substep& substep,
             Threads& threads) final;
  int sweep_count(Projector&, const Substep&) const final { return 0; }

 protected:
  /// Called when the structure is new. Sets `floors_` and may linearize with h = 1. Throws Error when the
  /// system is too large; the message names an alternative.
  virtual void prepare_system(LinearSystem& system, const ParticleView& particles) = 0;
  /// Fills dx and dlambda. Returns false on failure: this iteration then projects instead.
  virtual bool solve_system(LinearSystem& system, Threads& threads) = 0;

  /// Text for users about the floor on A, if there is one, and about failed iterations; may be empty.
  std::string floor_diagnostic() const;

  bool floors_ = false;  ///< whether A needs its floor
  LinearSystem system_;
  std::size_t failures_ = 0;  ///< iterations since `prepare` in which the system could not be solved

 private:
  void prepare_structure(const ParticleView& particles);
  void update_pins(const ParticleView& particles);
  bool solve_active(const ParticleView& particles, const Substep& substep, Threads& threads);
  void advance(const ParticleView& particles, const Substep& substep);
  double violation(const ParticleView& particles, const Substep& substep);

  std::vector<Projector*> linear_, others_;
  std::vector<float> inverse_mass_;  // per particle: inverse mass for which the structure was built [1/kg]
  bool solvable_ = false;
  std::vector<Vec4f> saved_;  // `moving` before an iteration
};

}  // namespace souple
