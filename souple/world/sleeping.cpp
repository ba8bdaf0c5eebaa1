#include "souple/world/sleeping.h"

#include "souple/objects/collider_record.h"
#include "souple/objects/object.h"
#include "souple/stages/sleeping.h"
#include "souple/stages/user_constraint.h"
#include "souple/world/call_scope.h"
#include "souple/world/contact_state.h"
#include "souple/world/impl.h"
#include "souple/world/step_scratch.h"
#include "souple/world/world.h"

namespace souple {
namespace {

SleepView sleep_view(WorldState& world) {
  return {world.stage_view(), world.contact->tables, world.colliders, world.constraints.users,
          *world.scratch->sleep};
}

}  // namespace

void wake_disturbed(WorldState& world, double dt) {
  world.report.asleep = wake_disturbed(sleep_view(world), dt);
}

void fall_asleep(WorldState& world, double dt) {
  const StartOfStep start{world.current.last_valid.position, world.current.last_valid.offset};
  world.report.asleep = fall_asleep(sleep_view(world), start, !world.callbacks.force_fields.empty(), dt);
}

void wake_island(WorldState& world, const Object& object) {
  wake_island(world.objects_view(), object, *world.scratch->sleep);
}

void wake_all(WorldState& world) {
  wake_all(world.objects_view(), *world.scratch->sleep);
}

void wake_particles_of(WorldState& world, const Projector& projector) {
  wake_particles_of(world.objects_view(), projector, *world.scratch->sleep);
}

void update_sleeping_masses(WorldState& world) {
  if (world.settings.sleeping.enabled) update_sleeping_masses(world.objects_view(), *world.scratch->sleep);
}

bool World::is_asleep(ObjectId id) const {
  return state().object(id).sleep.island != 0;
}

void World::wake(ObjectId id) {
  WorldState& world = state();
  const CallScope call(*world.calls, "wake", From::stages);
  wake_island(world, world.object(id));
}

}  // namespace souple
