#include "souple/multilevel/make_solver.h"

#include "souple/error.h"
#include "souple/linear_solvers/conjugate_gradient.h"
#include "souple/linear_solvers/dense.h"
#include "souple/linear_solvers/direct.h"
#include "souple/multilevel/automatic.h"
#include "souple/multilevel/hierarchical.h"
#include "souple/solver/gauss_seidel.h"
#include "souple/solver/jacobi.h"
#include "souple/solver/partitioned_gauss_seidel.h"

#include <fmt/core.h>

namespace souple {

std::unique_ptr<Solver> make_solver(const SolverSettings& settings) {
  switch (settings.kind) {
    case SolverKind::automatic:
      if (settings.colors > 0) return std::make_unique<PartitionedGaussSeidel>(settings);
      if (settings.sweep != Sweep::forward || settings.relaxation != 1 || settings.chebyshev > 0)
        return std::make_unique<GaussSeidel>(settings);
      return std::make_unique<Automatic>();
    case SolverKind::gauss_seidel:
      if (settings.colors > 0) return std::make_unique<PartitionedGaussSeidel>(settings);
      return std::make_unique<GaussSeidel>(settings);
    case SolverKind::jacobi:
      return std::make_unique<Jacobi>(settings);
    case SolverKind::direct:
      return std::make_unique<Direct>();
    case SolverKind::conjugate_gradient:
      return std::make_unique<ConjugateGradient>();
    case SolverKind::dense:
      return std::make_unique<Dense>();
    case SolverKind::hierarchical:
      return std::make_unique<Hierarchical>();
  }
  throw Error(fmt::format("no solver of kind {}", static_cast<int>(settings.kind)));
}

}  // namespace souple
