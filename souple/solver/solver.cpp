#include "souple/solver/solver.h"

#include "souple/error.h"
#include "souple/solver/gauss_seidel.h"
#include "souple/solver/hierarchical.h"

namespace souple {

std::unique_ptr<Solver> make_solver(const SolverSettings& settings) {
  switch (settings.kind) {
    case SolverKind::gauss_seidel:
      return std::make_unique<GaussSeidel>(settings);
    case SolverKind::hierarchical:
      return std::make_unique<Hierarchical>(settings);
    default:
      throw Error("this solver is not there yet: use gauss_seidel");
  }
}

}  // namespace souple
