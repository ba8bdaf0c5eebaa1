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
#include <memory>

namespace souple {
namespace {

/// Particles of objects, ascending; neighbors are joined.
template <class IsRemoved>
std::vector<IndexRange> particles_of(const WorldState& world, const IsRemoved& is_removed) {
  std::vector<IndexRange> ranges;
  for (const auto& object : world.objects) {
    if (!is_removed(object->id.value)) continue;
    if (!ranges.empty() && ranges.back().end == object->begin)
      ranges.back().end = object->reserved_end();
    else
      ranges.push_back({object->begin, object->reserved_end()});
  }
  return ranges;
}

void remove_objects(WorldState& world) {
  const auto is_removed = [&](std::uint32_t id) { return world.registry->removals.objects.contains(id); };
  wake_all(world);
  remove_ties_if(world, [&](const TieEnd& end) { return end.object && is_removed(end.object->value); });
  remove_joints_if(world,
                   [&](const JointSide& side) { return side.object() && is_removed(side.object()->value); });
  world.rigid->remove_if(is_removed);
  std::erase_if(world.flow.emitters, [&](const EmitterRecord& record) { return is_removed(record.fluid); });
  erase_particles(world, particles_of(world, is_removed));
  for (const auto& object : world.objects) {
    if (!is_removed(object->id.value)) continue;
    world.caches->mirrors.erase(object->id.value);
    world.registry->names.remove(object->name);
  }
  std::erase_if(world.objects, [&](const auto& object) { return is_removed(object->id.value); });
  world.registry->objects.reset(world.objects.size(),
                                [&](std::size_t o) { return world.objects[o]->id.value; });
  for (std::uint32_t o = 0; o < world.objects.size(); ++o)
    std::fill(world.object_of.data() + world.objects[o]->begin,
              world.object_of.data() + world.objects[o]->reserved_end(), o);
}

}  // namespace

bool contains_object(const WorldState& world, ObjectId id) {
  Removals& removals = world.registry->removals;
  const std::lock_guard lock(removals.mutex);
  return world.find_object(id) != nullptr && !removals.objects.contains(id.value);
}

void remove_later(WorldState& world, ObjectId id) {
  world.registry->removals.objects.insert(id.value);
  world.registry->removals.pending.store(true, std::memory_order_release);
}

void finish_removals(WorldState& world) {
  Removals& removals = world.registry->removals;
  const std::lock_guard lock(removals.mutex);
  if (!removals.pending.load(std::memory_order_relaxed)) return;
  Edit edit(world);
  // After an exception the world refuses what needs it whole.
  const auto end = [](Removals* ended) {
    ended->objects.clear();
    ended->pending.store(false, std::memory_order_release);
  };
  const std::unique_ptr<Removals, decltype(end)> at_end(&removals, end);
  remove_objects(world);
  edit.done();
}

}  // namespace souple
