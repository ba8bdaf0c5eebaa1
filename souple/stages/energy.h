#pragma once

#include "souple/solver/projector.h"
#include "souple/solver/solver.h"

#include <span>

namespace souple {

/// 1/2 C^T alpha^-1 C of all constraints with compliance > 0 [J].
double elastic_energy(std::span<Projector* const> constraints, const ParticleView& particles);

/// The part of it that steps can neither store nor return, because the solver does not converge [J]. The solver is
/// prepared for these constraints. 0 in PBD mode.
double unconverged_energy(std::span<Projector* const> constraints, const ParticleView& particles,
                          const Substep& substep, const Solver& solver);

}  // namespace souple
