#pragma once

#include "app/exit_codes.h"
#include "souple/world/world.h"

#include <cstdint>
#include <string>

namespace souple::app {

/// Says why a step is not `done`, or: "flag.json: the simulation diverged in frame 12: object "flag", particle 3 is no
/// longer finite".
std::string step_failure_text(const std::string& source, const StepReport& report, std::uint64_t frame);
/// The remedy of a step that diverged, as a second sentence; empty where the first one has it.
std::string step_remedy(const StepReport& report);
/// Builds what the first step needs. Throws Error, with the source's name, where that step would be refused.
void prepare(World& world, const std::string& source);
ExitCode exit_code(StepOutcome outcome);

}  // namespace souple::app
