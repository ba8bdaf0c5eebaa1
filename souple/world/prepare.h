#pragma once

#include "souple/world/state.h"

// Data that must be up to date before a step: constraints, their colors, the solver, contact tables.

namespace souple {

/// Rebuilds what changed since the last step: constraints, their colors, contact tables.
void bring_up_to_date(WorldState& world);
/// Rebuilds only the constraints, their colors and their order; contacts keep the result of the last step.
void bring_constraints_up_to_date(WorldState& world);
/// Releases distance joints whose time has come, and brings everything up to date. Returns false, with a message in the
/// report, if that failed.
bool prepare_step(WorldState& world, double dt);
Substep substep_of(const Settings& settings, double dt);

}  // namespace souple
