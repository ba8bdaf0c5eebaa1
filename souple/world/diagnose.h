#pragma once

#include "souple/world/state.h"

namespace souple {

/// Builds what has changed since the last step: constraints, their colors, what contacts need to know.
void bring_up_to_date(WorldState& world);
/// The constraints and their colors only: contacts stay what the last step left.
void bring_constraints_up_to_date(WorldState& world);
/// Readies the world for a step of dt seconds: builds what changed, empties the report. False, with a report
/// that says why, when dt is not positive and finite.
bool begin_step(WorldState& world, double dt);
/// Keeps the state that end_step puts back after a bad step.
void save_last_valid(WorldState& world);
Substep substep_of(const Settings& settings, double dt);
/// Completes the report; when a number went bad, names the particle and puts the last good state back.
void end_step(WorldState& world, bool valid);
/// Runs callbacks; an exception is reported, not passed on.
void run_callbacks(World& self, WorldState& world, const std::vector<std::function<void(World&)>>& callbacks);

}  // namespace souple
