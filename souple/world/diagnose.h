#pragma once

#include "souple/world/state.h"

namespace souple {

/// Rebuilds what changed since the last step: constraints, their colors, contact tables.
void bring_up_to_date(WorldState& world);
/// Rebuilds only the constraints and their colors; contacts keep the result of the last step.
void bring_constraints_up_to_date(WorldState& world);
/// Prepares the world for a step of dt seconds: rebuilds what changed, clears the report, applies emitters
/// and drains. Returns false, with a message in the report, if dt is not positive and finite, if a callback
/// called step, or if rebuilding failed.
bool begin_step(WorldState& world, double dt);
/// Saves the state that end_step restores after a step with non-finite values.
void save_last_valid(WorldState& world);
Substep substep_of(const Settings& settings, double dt);
/// Completes the report. If the step was not valid, reports the particle and restores the last valid state.
void end_step(WorldState& world, bool valid);
/// Runs callbacks; an exception is reported, not passed on.
void run_callbacks(World& self, WorldState& world,
                   const CallbackList<std::function<void(World&)>>& callbacks);

}  // namespace souple
