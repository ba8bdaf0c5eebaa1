#include "souple/studies/make_solver.h"

#include "souple/error.h"
#include "souple/multilevel/automatic.h"
#include "souple/multilevel/hierarchical.h"
#include "souple/solver/gauss_seidel.h"
#include "souple/studies/accelerated_gauss_seidel.h"
#include "souple/studies/conjugate_gradient.h"
#include "souple/studies/dense.h"
#include "souple/studies/direct.h"
#include "souple/studies/jacobi.h"
#include "souple/studies/partitioned_gauss_seidel.h"

#include <fmt/core.h>

namespace souple {

namespace {

std::unique_ptr<Solver> make_gauss_seidel(const SolverSettings& settings) {
  if (settings.colors > 0) return std::make_unique<PartitionedGaussSeidel>(settings);
  if (settings.sweep != Sweep::forward || settings.chebyshev > 0)
    return std::make_unique<AcceleratedGaussSeidel>(settings);
  return std::make_unique<GaussSeidel>();
}

}  // namespace

std::unique_ptr<Solver> make_solver(const SolverSettings& settings) {
  switch (settings.kind) {
    case SolverKind::automatic:
      if (settings.colors == 0 && settings.sweep == Sweep::forward && settings.relaxation == 1 &&
          settings.chebyshev <= 0)
        return std::make_unique<Automatic>();
      return make_gauss_seidel(settings);
    case SolverKind::gauss_seidel:
      return make_gauss_seidel(settings);
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
