#pragma once

#include "souple/world/callbacks.h"
#include "souple/world/state.h"

#include <string>

// The report of a step, and its treatment of states that are not finite.

namespace souple {

/// True if a function that the world is calling has called step. The report of the step that runs, or of the next one,
/// says so.
bool refuse_nested_step(WorldState& world);
/// The step that was to begin does nothing, and its report says why.
void refuse_step(WorldState& world, const std::string& reason);
/// Clears the report. Returns false, with a message in it, if dt is not positive and finite.
bool begin_report(WorldState& world, double dt);
/// Counts the step that begins, and its particles.
void count_step(WorldState& world);
/// Saves the state that restore_last_valid restores after a step with non-finite values.
void save_last_valid(WorldState& world);
/// Reports the particle that is not finite and restores the state before the step.
void restore_last_valid(WorldState& world);
/// The objects whose balance has been measured.
void report_balance(WorldState& world);
/// Fluids, errors of users' constraints, residuals and, after a valid step, flags. Contacts have reported.
void end_report(WorldState& world, bool valid);
/// Runs callbacks; an exception is reported, not passed on.
void run_callbacks(World& self, WorldState& world,
                   const CallbackList<std::function<void(World&)>>& callbacks);

}  // namespace souple
