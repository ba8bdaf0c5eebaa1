#include "souple/world/state.h"

#include "souple/fluid/emitter_record.h"
#include "souple/fluid/stage/fluids.h"
#include "souple/objects/collider_record.h"
#include "souple/objects/constraint_groups.h"
#include "souple/objects/constraint_sets.h"
#include "souple/objects/object.h"
#include "souple/queries/caches.h"
#include "souple/solver/solver.h"
#include "souple/stages/rigid_stage.h"
#include "souple/stages/sleeping.h"
#include "souple/stages/stage_view.h"
#include "souple/stages/ties.h"
#include "souple/stages/user_constraint.h"
#include "souple/studies/segment_triangle/choice.h"
#include "souple/world/call_scope.h"
#include "souple/world/callbacks.h"
#include "souple/world/contact_state.h"
#include "souple/world/registry.h"
#include "souple/world/step_scratch.h"

#include <fmt/core.h>

namespace souple {

StepScratch::StepScratch() : sleep(std::make_unique<SleepScratch>()) {}
StepScratch::~StepScratch() = default;

WorldState::WorldState()
    : registry(std::make_unique<Registry>()),
      constraints{std::make_unique<ConstraintSets>(),
                  std::make_unique<ConstraintGroups>(),
                  {},
                  {},
                  std::make_unique<Ties>(),
                  {},
                  0},
      contact(std::make_unique<ContactState>()),
      fluids(std::make_unique<Fluids>()),
      rigid(std::make_unique<RigidStage>()),
      scratch(std::make_unique<StepScratch>()),
      callbacks(std::make_unique<Callbacks>()),
      calls(std::make_unique<Calls>()),
      caches(std::make_unique<Caches>()) {}
WorldState::~WorldState() = default;

Object* WorldState::find_object(ObjectId id) const {
  const std::optional<std::size_t> at = registry->objects.find(id.value);
  return at ? objects[*at].get() : nullptr;
}

void throw_stale(std::string_view what, std::uint32_t handle) {
  throw Error(
      fmt::format("no {} has the handle {}: it was removed, or belongs to another world", what, handle));
}

Object& WorldState::object(ObjectId id) {
  if (Object* const found = find_object(id)) return *found;
  throw_stale("object", id.value);
}

ColliderRecord& WorldState::collider(ColliderId id) {
  if (const std::optional<std::size_t> at = registry->colliders.find(id.value)) return colliders[*at];
  throw_stale("collider", id.value);
}

void WorldState::teleport_particle(std::size_t i, const Vec3d& x) {
  contact->check_intersections = true;
  set_position(i, x);
}

void WorldState::set_position(std::size_t i, const Vec3d& x) {
  const Vec3f rounded(x);
  particles.position[i].set_xyz(rounded);
  particles.offset[i].set_xyz(Vec3f(x - Vec3d(rounded)));
}

void Callbacks::erase_removed() {
  for (auto* lists : {&before, &after})
    for (auto& callbacks : *lists) callbacks.erase_removed();
  force_fields.erase_removed();
}

std::string WorldState::unique_name(const std::string& wanted, std::string_view base) const {
  if (wanted.empty()) return registry->names.first_free(base);
  registry->names.require_free(wanted);
  return wanted;
}

const Object& WorldState::object(ObjectId id) const {
  return const_cast<WorldState*>(this)->object(id);
}

StageView WorldState::stage_view() {
  return {objects_view(), settings, *threads, warnings, time};
}

QueryView WorldState::query_view() const {
  // A function that a thread of the step calls must not wait for these threads.
  Threads* const free_threads = calls->threads_are_busy() ? nullptr : threads.get();
  return {particles,    objects, colliders, time, version, crossing_test_of(settings.segment_test),
          free_threads, *caches};
}

ParticleView WorldState::view() {
  return objects_view().view();
}

}  // namespace souple
