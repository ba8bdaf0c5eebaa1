#pragma once

#include "souple/solver/projector.h"
#include "souple/solver/threads.h"

#include <memory>
#include <span>
#include <string>
#include <string_view>

namespace souple {

/// How the constraints of a substep are solved; docs/solvers.md compares them.
enum class SolverKind {
  gauss_seidel,        ///< nonlinear, colored: the default
  jacobi,              ///< all constraints from the same positions, corrections averaged
  direct,              ///< the linearized system by a sparse Cholesky factorization
  conjugate_gradient,  ///< the same without a factorization, for what is too large for one
  dense,               ///< the same by SVD pseudo-inverse: small scenes only
  hierarchical         ///< levels of coarser constraints (Müller 2008)
};

/// In which order Gauss-Seidel visits the colors.
enum class Sweep {
  forward,   ///< first to last, every iteration
  symmetric  ///< forward, then backward, every iteration; kinds without a linear form once, last
};

struct SolverSettings {
  SolverKind kind = SolverKind::gauss_seidel;
  Sweep sweep = Sweep::forward;
  /// Factor on every correction, in (0, 2): over-relaxation above 1.
  float relaxation = 1;
  /// Chebyshev acceleration of the iterations: the spectral radius rho in [0, 1) that it assumes; 0: none.
  float chebyshev = 0;
  /// Gauss-Seidel: colors to which phantom particles cut the constraint graph (Fratarcangeli and Pellacini
  /// 2015); 0: as many as it takes without.
  int colors = 0;
};

inline bool operator==(const SolverSettings& a, const SolverSettings& b) {
  return a.kind == b.kind && a.sweep == b.sweep && a.relaxation == b.relaxation &&
         a.chebyshev == b.chebyshev && a.colors == b.colors;
}

/// Moves the particles of a world towards satisfying all constraints, once per substep.
class Solver {
 public:
  virtual ~Solver() = default;

  /// As users name it.
  virtual std::string_view name() const = 0;
  /// After constraints or particles changed and before the next `solve`; projectors are prepared already.
  /// Throws Error where the solver cannot take the scene (too large, no mesh), saying what to use instead.
  virtual void prepare(std::span<Projector* const> projectors, const ParticleView& particles) = 0;
  /// All iterations of a substep. `projectors` are in the order they are solved, contacts last; their
  /// begin_substep has been called.
  virtual void solve(std::span<Projector* const> projectors, const ParticleView& particles,
                     const Substep& substep, Threads& threads) = 0;
  /// What users should know of how it went (a floor on alpha, iterations of conjugate gradients), or nothing.
  virtual std::string diagnostic() const { return {}; }
};

std::unique_ptr<Solver> make_solver(const SolverSettings& settings);

/// Projects all constraints of a projector once, color after color, each on all threads.
void sweep(Projector& projector, const ParticleView& particles, const Substep& substep, Threads& threads);

}  // namespace souple
