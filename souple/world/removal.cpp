#include "souple/world/removal.h"

#include "souple/fluid/emitter_record.h"
#include "souple/objects/object.h"
#include "souple/queries/caches.h"
#include "souple/stages/rigid_stage.h"
#include "souple/world/add.h"
#include "souple/world/joints/joints.h"
#include "souple/world/joints/ties.h"
#include "souple/world/recover.h"
#include "souple/world/registry.h"
#include "souple/world/sleeping.h"

#include <algorithm>

namespace souple {
namespace {

/// Particles of the removed objects, ascending; neighbors are joined.
std::vector<IndexRange> removed_particles(const WorldState& world) {
  std::vector<IndexRange> ranges;
  for (const auto& object : world.objects) {
    if (!object->removed) continue;
    if (!ranges.empty() && ranges.back().end == object->begin)
      ranges.back().end = object->reserved_end();
    else
      ranges.push_back({object->begin, object->reserved_end()});
  }
  return ranges;
}

void remove_objects(WorldState& world) {
  const auto is_removed = [&](std::uint32_t id) { return world.object({id}).removed; };
  wake_all(world);
  remove_ties_if(world, [&](const TieEnd& end) { return end.object && is_removed(end.object->value); });
  remove_joints_if(world, [&](const JointSide& side) { return side.object() && is_removed(side.object()->value); });
  world.rigid->remove_if(is_removed);
  std::erase_if(world.flow.emitters,
                [&](const EmitterRecord& record) { return is_removed(record.fluid); });
  erase_particles(world, removed_particles(world));
  for (const auto& object : world.objects) {
    if (!object->removed) continue;
    world.caches->mirrors.erase(object->id.value);
    world.registry->names.remove(object->name);
  }
  std::erase_if(world.objects, [](const auto& object) { return object->removed; });
  world.registry->objects.reset(world.objects.size(),
                                [&](std::size_t o) { return world.objects[o]->id.value; });
  for (std::uint32_t o = 0; o < world.objects.size(); ++o)
    std::fill(world.object_of.begin() + world.objects[o]->begin,
              world.object_of.begin() + world.objects[o]->reserved_end(), o);
}

}  // namespace

void remove_later(WorldState& world, Object& object) {
  object.removed = true;
  world.removals->pending.store(true, std::memory_order_release);
}

void finish_removals(WorldState& world) {
  const std::lock_guard lock(world.removals->mutex);
  if (!world.removals->pending.load(std::memory_order_relaxed)) return;
  Edit edit(world);
  // After an exception the world refuses what needs it whole.
  const auto end = [](Removals* removals) { removals->pending.store(false, std::memory_order_release); };
  const std::unique_ptr<Removals, decltype(end)> at_end(world.removals.get(), end);
  remove_objects(world);
  edit.done();
}

}  // namespace souple
