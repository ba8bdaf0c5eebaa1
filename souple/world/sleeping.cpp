#include "souple/world/sleeping.h"

#include "souple/objects/collider_record.h"
#include "souple/objects/object.h"
#include "souple/stages/rigid_joints.h"
#include "souple/stages/rigid_stage.h"
#include "souple/stages/sleeping.h"
#include "souple/stages/user_constraint.h"
#include "souple/world/call_scope.h"
#include "souple/world/callbacks.h"
#include "souple/world/contact_state.h"
#include "souple/world/impl.h"
#include "souple/world/joints/ties.h"
#include "souple/world/registry.h"
#include "souple/world/step_scratch.h"
#include "souple/world/world.h"

namespace souple {
namespace {

bool is_driven(const WorldState& world, const JointSide& side) {
  if (!side.collider()) return false;
  return !world.colliders[*world.registry->colliders.find(side.collider()->value)].options.motion.is_static();
}

void list_joined(const WorldState& world, JoinedObjects& joined) {
  joined.pairs.clear(), joined.driven.clear();
  const RigidJoints& joints = world.rigid->joints();
  for (std::size_t j = 0; j < joints.records().size(); ++j) {
    if (joints.joints().state[j].broken) continue;
    const JointRecord& record = joints.records()[j];
    const auto row_of = [&](const JointSide& side) {
      return static_cast<std::uint32_t>(*world.registry->objects.find(side.object()->value));
    };
    if (record.a.object() && record.b.object())
      joined.pairs.emplace_back(row_of(record.a), row_of(record.b));
    else if (is_driven(world, record.a) || is_driven(world, record.b))
      joined.driven.push_back(row_of(record.a.object() ? record.a : record.b));
  }
  list_tied(world, joined);
}

SleepView sleep_view(WorldState& world) {
  list_joined(world, world.scratch->sleep->joined);
  return {world.stage_view(), world.contact->tables, world.colliders, world.constraints.users,
          *world.scratch->sleep};
}

}  // namespace

void wake_disturbed(WorldState& world, double dt) {
  world.report.asleep = wake_disturbed(sleep_view(world), dt);
}

void fall_asleep(WorldState& world, double dt) {
  const StartOfStep start{world.current.last_valid.position, world.current.last_valid.offset};
  world.report.asleep = fall_asleep(sleep_view(world), start, !world.callbacks->force_fields.empty(), dt);
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
