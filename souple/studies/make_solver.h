#pragma once

#include "souple/solver/solver.h"

#include <memory>

namespace souple {

/// The solver of settings.kind.
std::unique_ptr<Solver> make_solver(const SolverSettings& settings);

}  // namespace souple
