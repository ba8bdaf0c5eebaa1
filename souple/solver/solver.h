#pragma once

#include "souple/solver/left_out.h"
#include "souple/solver/projector.h"
#include "souple/threads/threads.h"

#include <span>
#include <string>
#include <string_view>

namespace souple {

/// Solver of the constraints of a substep; docs/solvers.md compares them.
enum class SolverKind {
  automatic,     ///< the default: Gauss-Seidel, levels for cloth, more sweeps for stiff tets, exact ropes
  gauss_seidel,  ///< nonlinear, colored
  jacobi,        ///< all constraints projected from the same positions, corrections averaged
  direct,        ///< the linearized system by a sparse Cholesky factorization
  conjugate_gradient,  ///< the linearized system without a factorization, for scenes too large for one
  dense,               ///< the linearized system by SVD pseudo-inverse: small scenes only
  hierarchical         ///< levels of coarser constraints (Müller 2008)
};

/// The order in which Gauss-Seidel visits the colors.
enum class Sweep {
  forward,   ///< first to last, every iteration
  symmetric  ///< forward, then backward, every iteration; kinds without a linear form once, last
};

struct SolverSettings {
  SolverKind kind = SolverKind::automatic;
  Sweep sweep = Sweep::forward;
  /// Factor of every correction, in (0, 2): over-relaxation above 1.
  float relaxation = 1;
  /// Chebyshev acceleration of the iterations: the assumed spectral radius rho in [0, 1); 0: none.
  float chebyshev = 0;
  /// Gauss-Seidel: number of colors to which phantom particles reduce the constraint graph (Fratarcangeli and
  /// Pellacini 2015); 0: as many colors as are needed without phantoms.
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

  /// The name that users write.
  virtual std::string_view name() const = 0;
  /// Call after constraints or particles changed and before the next `solve`; projectors are prepared
  /// already. Throws Error when the solver cannot handle the scene (too large, too many coupled rows); the
  /// message names an alternative.
  virtual void prepare(std::span<Projector* const> projectors, const ParticleView& particles) = 0;
  /// The same on several threads, for solvers that take long to prepare. The default uses the caller's alone.
  virtual void prepare(std::span<Projector* const> projectors, const ParticleView& particles, Threads&) {
    prepare(projectors, particles);
  }
  /// Runs all iterations of a substep. `projectors` are in solving order, contacts last; begin_substep of
  /// each has been called.
  virtual void solve(std::span<Projector* const> projectors, const ParticleView& particles,
                     const Substep& substep, Threads& threads) = 0;
  /// Number of sweeps of a substep that supply the stiffness of a projector's constraints; 0: they are solved exactly.
  virtual int sweep_count(const Projector&, const Substep& substep) const { return substep.iterations; }
  /// Constraints that are solved exactly although sweeps supply others of their projector.
  virtual LeftOut solved_exactly(const Substep&) const { return {}; }
  /// Information for users about the solution (a floor on alpha, iterations of conjugate gradients), or
  /// empty.
  virtual std::string diagnostic() const { return {}; }
};

/// Projects all constraints of a projector once, color after color, each color on all threads.
void sweep(Projector& projector, const ParticleView& particles, const Substep& substep, Threads& threads);

/// Sweeps each projector as often as it needs to be as stiff as its material (Projector::sweeps_needed), in
/// rounds. Contacts take part in every round: a stiff body that is swept alone pushes itself back into them and
/// trembles. With stored multipliers there is one round. Where there are more than 10 rounds, each advances the
/// particles by a part of their motion in the substep; projectors with fewer sweeps take part in the last rounds.
/// `motion` is work space.
void sweep_as_needed(std::span<Projector* const> projectors, const ParticleView& particles,
                     const Substep& substep, Threads& threads, std::vector<Vec4f>& motion);

}  // namespace souple
