#include "souple/fluid/emitter.h"
#include "souple/objects/object.h"
#include "souple/world/flow.h"
#include "souple/world/impl.h"
#include "souple/world/sleeping.h"
#include "souple/world/world.h"

#include <algorithm>
#include <string>

#include <fmt/core.h>

// The API of emitters and drains. Their simulation is in flow.cpp.

namespace souple {
namespace {

template <class Record>
Record& find(std::vector<Record>& records, std::uint32_t id, const char* kind) {
  const auto found = std::find_if(records.begin(), records.end(),
                                  [&](const Record& record) { return record.id.value == id; });
  if (found != records.end()) return *found;
  throw Error(fmt::format("no {} has the handle {}: it was removed, or belongs to another world", kind, id));
}

}  // namespace

EmitterId World::add_emitter(ObjectId fluid, const Emitter& emitter) {
  WorldState& world = impl_->state;
  world.require_between_steps("add_emitter");
  const Object& object = world.object(fluid);
  const std::string owner = "an emitter of " + object.name;
  if (object.kind != ObjectKind::fluid)
    throw Error(owner + ": it is a " + std::string(kind_name(object.kind)) + ", expected a fluid");
  validate(emitter, owner);
  require_layer_size(emitter, std::get<FluidMaterial>(object.material).spacing, owner);
  wake_island(world, object);
  world.flow.emitters.push_back(
      {{world.next_id++}, fluid.value, emitter, layers_before(world, object, emitter)});
  return world.flow.emitters.back().id;
}

void World::set_emitter(EmitterId id, const Emitter& emitter) {
  WorldState& world = impl_->state;
  world.require_between_steps("set_emitter");
  EmitterRecord& record = find(world.flow.emitters, id.value, "emitter");
  const Object& object = world.object({record.fluid});
  const std::string owner = "an emitter of " + object.name;
  validate(emitter, owner);
  require_layer_size(emitter, std::get<FluidMaterial>(object.material).spacing, owner);
  record.emitter = emitter;
  record.layers = layers_before(world, object, emitter);
}

void World::remove(EmitterId id) {
  WorldState& world = impl_->state;
  world.require_between_steps("remove");
  world.flow.emitters.erase(world.flow.emitters.begin() +
                            (&find(world.flow.emitters, id.value, "emitter") - world.flow.emitters.data()));
}

DrainId World::add_drain(const Drain& drain) {
  WorldState& world = impl_->state;
  world.require_between_steps("add_drain");
  validate(drain, "a drain");
  wake_all(world);
  world.flow.drains.push_back({{world.next_id++}, drain, 0});
  return world.flow.drains.back().id;
}

void World::remove(DrainId id) {
  WorldState& world = impl_->state;
  world.require_between_steps("remove");
  world.flow.drains.erase(world.flow.drains.begin() +
                          (&find(world.flow.drains, id.value, "drain") - world.flow.drains.data()));
}

}  // namespace souple
