#include "souple/world/recover.h"

#include "souple/fluid/stage/fluids.h"
#include "souple/objects/build_elements.h"
#include "souple/objects/constraint_groups.h"
#include "souple/objects/constraint_sets.h"
#include "souple/objects/object.h"
#include "souple/solver/solver.h"
#include "souple/stages/rigid_stage.h"
#include "souple/stages/sleeping.h"
#include "souple/stages/ties.h"
#include "souple/stages/user_constraint.h"
#include "souple/world/call_scope.h"
#include "souple/world/callbacks.h"
#include "souple/world/contact_state.h"
#include "souple/world/step_scratch.h"

#include <algorithm>
#include <memory>
#include <new>
#include <utility>

namespace souple {
namespace {

void forget_projectors(WorldState& world) {
  world.constraints.order.clear();
  world.constraints.without_contacts = 0;
}

/// A merge that failed has lost constraints: all objects build theirs again.
void rebuild_constraints(WorldState& world) {
  for (const auto& object : world.objects) build_elements(*object, SetKinds::all());
  auto of_elements = std::make_unique<ConstraintSets>();
  auto of_groups = std::make_unique<ConstraintGroups>();
  world.constraints.object_projectors.clear();
  world.constraints.of_elements = std::move(of_elements);
  world.constraints.of_groups = std::move(of_groups);
}

}  // namespace

Edit::Edit(WorldState& world) : world_(world) {
  world.calls->broken = true;
}

void Edit::done() {
  world_.calls->broken = false;
}

namespace {

/// Without memory the sentence is missing.
void report_abandoned(StepReport& report) noexcept {
  report.outcome = StepOutcome::abandoned;
  try {
    report.message =
        "step: an exception, such as out of memory, ended the step half way; its particles are those before "
        "it: restore a snapshot, or build the world again";
  } catch (const std::bad_alloc&) {
    report.message.clear();
  }
}

}  // namespace

void abandon_step(WorldState& world, double start) noexcept {
  world.calls->broken = true;
  report_abandoned(world.report);
  if (world.current.saved) {
    const LastValid& valid = world.current.last_valid;
    Particles& particles = world.particles;
    std::copy(valid.position.begin(), valid.position.end(), particles.position.begin());
    std::copy(valid.offset.begin(), valid.offset.end(), particles.offset.begin());
    std::copy(valid.velocity.begin(), valid.velocity.end(), particles.velocity.begin());
    std::copy(valid.spin.begin(), valid.spin.end(), particles.spin.begin());
    world.rigid->undo();
    world.constraints.ties->undo();
  }
  world.time = start;
  world.current.running = false;
  ++world.version;
  forget_projectors(world);
  world.contact->invalidate();
  world.callbacks->erase_removed();
}

void start_afresh(WorldState& world) {
  forget_projectors(world);
  if (world.dirty.constraints || world.dirty.groups || world.dirty.objects) rebuild_constraints(world);
  auto contact = std::make_unique<ContactState>();
  contact->pairs = world.contact->pairs;
  contact->tracker = world.contact->tracker;
  auto fluids = std::make_unique<Fluids>();
  auto scratch = std::make_unique<StepScratch>();
  world.contact = std::move(contact);
  world.fluids = std::move(fluids);
  world.scratch = std::move(scratch);
  world.solving.solver.reset();
  world.dirty = {};
}

}  // namespace souple
