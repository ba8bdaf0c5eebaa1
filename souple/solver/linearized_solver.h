#pragma once

#include "souple/solver/linear_system.h"
#include "souple/solver/solver.h"

#include <vector>

namespace souple {

/// What the solvers of the global system share: each iteration linearizes all constraints where the particles
/// are (linear_system.h), solves the system at once, and moves by what it says, or by a part of it. Kinds
/// without a linear form (contacts, shape matching, enclosed volumes, custom constraints) are projected after
/// each iteration, by Gauss-Seidel.
///
/// The linearization holds near where it was made only, and a rigid cloth has folds in which it says
/// nonsense. So a move may not deform a constraint by more than half of its size, and is halved until it
/// leaves less than it found of
///
///   1/2 b^T A^-1 b + 1/2 dx^T M dx
///
/// (b taken anew after the move): the very function that the linear system minimizes. After four halvings it
/// is taken as it is.
class LinearizedSolver : public Solver {
 public:
  void prepare(std::span<Projector* const> projectors, const ParticleView& particles) final;
  void solve(std::span<Projector* const> projectors, const ParticleView& particles, const Substep& substep,
             Threads& threads) final;

 protected:
  /// The structure is new. Sets `floors` and may linearize with h = 1; throws Error where the system is too
  /// large, saying what to use instead.
  virtual void prepare_system(LinearSystem& system, const ParticleView& particles) = 0;
  /// Fills dx and dlambda. False: it failed, and this iteration projects instead.
  virtual bool solve_system(LinearSystem& system, Threads& threads) = 0;

  /// How the floor on A, if there is one, and iterations that failed are told to users; may be empty.
  std::string floor_diagnostic() const;

  bool floors_ = false;  ///< A needs its floor
  LinearSystem system_;
  std::size_t failures_ = 0;  ///< iterations since `prepare` in which the system could not be solved

 private:
  void prepare_structure(const ParticleView& particles);
  void update_pins(const ParticleView& particles);
  bool solve_active(const ParticleView& particles, const Substep& substep, Threads& threads);
  void advance(const ParticleView& particles, const Substep& substep);
  double violation(const ParticleView& particles, const Substep& substep);

  std::vector<Projector*> linear_, others_;
  std::vector<float> inverse_mass_;  // of each particle, for which the structure was made
  bool solvable_ = false;
  std::vector<Vec4f> saved_;  // `moving` before an iteration
};

}  // namespace souple
