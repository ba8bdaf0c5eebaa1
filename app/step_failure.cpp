#include "app/step_failure.h"

#include "souple/error.h"

#include <fmt/core.h>

namespace souple::app {

std::string step_failure_text(const std::string& source, const StepReport& report, std::uint64_t frame) {
  if (report.outcome == StepOutcome::diverged)
    return fmt::format(
        "{}: the simulation diverged in frame {}: object \"{}\", particle {} is no longer finite", source,
        frame, report.bad_object, report.bad_vertex);
  return fmt::format("{}: frame {}: {}", source, frame, report.message);
}

std::string step_remedy(const StepReport& report) {
  if (report.outcome != StepOutcome::diverged) return {};
  return ". " + std::string(advice(Flag::non_finite));
}

void prepare(World& world, const std::string& source) {
  try {
    world.prepare();
  } catch (const Error& error) {
    throw Error(source + ": " + error.what());
  }
}

ExitCode exit_code(StepOutcome outcome) {
  switch (outcome) {
    case StepOutcome::done:
      return success;
    case StepOutcome::refused:
      return bad_input;
    case StepOutcome::diverged:
      return non_finite;
    case StepOutcome::abandoned:
      break;
  }
  return failed;
}

}  // namespace souple::app
