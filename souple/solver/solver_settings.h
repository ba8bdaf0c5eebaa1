#pragma once

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

}  // namespace souple
