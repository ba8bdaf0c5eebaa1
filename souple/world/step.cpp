#include "souple/world/arrivals.h"
#include "souple/world/call_scope.h"
#include "souple/world/callbacks.h"
#include "souple/world/contact_state.h"
#include "souple/world/contacts.h"
#include "souple/world/flow/flow.h"
#include "souple/world/impl.h"
#include "souple/world/prepare.h"
#include "souple/world/recover.h"
#include "souple/world/sleeping.h"
#include "souple/world/stages.h"
#include "souple/world/step_report.h"
#include "souple/world/world.h"

#include <chrono>

namespace souple {
namespace {

/// Runs a stage between the user's callbacks and adds its time to the report.
template <class Function>
void run(World& self, WorldState& world, Stage stage, const Function& function) {
  const auto index = static_cast<std::size_t>(stage);
  const auto start = std::chrono::steady_clock::now();
  run_callbacks(self, world, world.callbacks->before[index]);
  function();
  run_callbacks(self, world, world.callbacks->after[index]);
  const std::chrono::duration<double, std::milli> spent = std::chrono::steady_clock::now() - start;
  world.report.milliseconds[index] += spent.count();
}

StepReport refusal(const char* reason) {
  StepReport none;
  none.outcome = StepOutcome::refused;
  none.message = reason;
  return none;
}

/// The report of a world that was moved from.
const StepReport& report_of_no_world() {
  static const StepReport report = refusal("step: the world was moved from; nothing was done");
  return report;
}

/// The report of a step within a step, which has its own.
const StepReport& report_of_nested_step() {
  static const StepReport report =
      refusal("step: called from a function that the world is calling; nothing was done");
  return report;
}

/// The prologue. Returns false, with a message in the report, if there can be no step.
bool begin_step(WorldState& world, double dt) {
  if (!begin_report(world, dt) || !prepare_step(world, dt)) return false;
  world.contact->invalidate();
  begin_arrivals(world, dt);
  update_flow(world, dt);
  update_fluid_counts(world);
  begin_fluids(world, dt);
  count_step(world);
  return true;
}

/// The epilogue.
void end_step(WorldState& world, double dt, bool valid) {
  if (valid) fall_asleep(world, dt);
  if (valid) end_flow(world);
  if (!valid) restore_last_valid(world);
  end_arrivals(world, valid);
  ++world.version;
  world.current.version_after = valid ? world.version : 0;
  world.contact->valid = true;
  report_contacts(world);
  world.contact->tracker.end_step(world, valid);
  world.callbacks->erase_removed();
  end_report(world, valid);
}

/// A step of World::step.
void advance(World& self, WorldState& world, double dt) {
  if (!begin_step(world, dt)) return;
  Substep substep = substep_of(world.settings, dt);
  const double start = world.time;
  bool valid = true;
  world.current.running = true;
  const ActiveScope awake(*world.threads);
  save_last_valid(world);
  run(self, world, Stage::broad_phase, [&] { find_candidates(world, dt); });
  begin_angular_momentum(world);
  for (int i = 1; valid && i <= substep.count; ++i) {
    world.current.last_substep = i == substep.count;
    substep.number = i - 1;
    run(self, world, Stage::integrate, [&] { integrate(world, substep); });
    run(self, world, Stage::fluids, [&] { solve_incompressibility(world, substep); });
    run(self, world, Stage::contacts, [&] { generate_contacts(world, substep); });
    run(self, world, Stage::solve, [&] { solve(world, substep); });
    run(self, world, Stage::finish, [&] { valid = finish(world, substep); });
    run(self, world, Stage::velocity, [&] { valid = update_velocities(world, substep); });
    world.contact->tracker.end_substep(world);
    world.time = start + dt * i / substep.count;
  }
  if (valid) run(self, world, Stage::foam, [&] { step_foam(world, start, dt); });
  world.current.running = false;
  if (!valid) world.time = start;
  end_step(world, dt, valid);
}

}  // namespace

const StepReport& World::step(double dt) {
  if (!impl_) return report_of_no_world();
  WorldState& world = state();
  if (refuse_nested_step(world)) return report_of_nested_step();
  require_whole(*world.calls, "step");
  const StepScope scope(*world.calls);
  const double start = world.time;
  world.current.saved = false;
  try {
    advance(*this, world, dt);
  } catch (...) {
    abandon_step(world, start);
    throw;
  }
  return world.report;
}

}  // namespace souple
