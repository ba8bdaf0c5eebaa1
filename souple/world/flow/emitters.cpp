#include "souple/fluid/emission.h"
#include "souple/objects/checks.h"
#include "souple/objects/object.h"
#include "souple/world/call_scope.h"
#include "souple/world/flow/flow.h"
#include "souple/world/impl.h"
#include "souple/world/registry.h"
#include "souple/world/sleeping.h"
#include "souple/world/world.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>

#include <fmt/core.h>

// The API of emitters and drains. Their simulation is in flow.cpp and souple/fluid/emission.cpp.

namespace souple {
namespace {

constexpr double max_layer_particles = 1e5;

void require_times(double start, double end, std::string_view owner) {
  if (!(std::abs(start) <= range::time) || !(end >= start))
    throw Error(fmt::format(
        "{}: it is active from {:g} to {:g} s, expected a start from {:g} to {:g} s and an end not before it",
        owner, start, end, -range::time, range::time));
}

void require_valid(const Emitter& emitter, std::string_view owner) {
  require_within(owner, "position", Vec3d(emitter.position), range::coordinate);
  if (!is_finite(emitter.direction) || !(length_squared(Vec3d(emitter.direction)) > 1e-12))
    throw Error(fmt::format("{}: its direction is not finite, or zero", owner));
  if (!(emitter.radius >= 0) || !std::isfinite(emitter.radius))
    throw Error(fmt::format("{}: radius is {:g} m, expected a finite number >= 0", owner, emitter.radius));
  check_all(owner, {{"speed", double(emitter.speed), range::positive, range::speed}});
  require_times(emitter.start, emitter.end, owner);
}

void require_valid(const Drain& drain, std::string_view owner) {
  validate(drain.shape, owner);
  validate(drain.pose, owner);
  if (!(drain.rate > 0))
    throw Error(fmt::format("{}: rate is {:g} m^3/s, expected a number > 0", owner, drain.rate));
  require_times(drain.start, drain.end, owner);
}

void require_layer_size(const Emitter& emitter, float spacing, std::string_view owner) {
  const double ratio = static_cast<double>(emitter.radius / spacing);
  if (pi * ratio * ratio > max_layer_particles)
    throw Error(
        fmt::format("{}: radius is {:g} m, {:g} spacings: a layer would have more than {:g} particles", owner,
                    emitter.radius, ratio, max_layer_particles));
}

/// The spacing of a fluid [m]. Throws Error unless the emitter may be one of it.
double checked_spacing(const Emitter& emitter, const Object& fluid, std::string_view owner) {
  require_valid(emitter, owner);
  const float spacing = std::get<FluidMaterial>(fluid.material).spacing;
  require_layer_size(emitter, spacing, owner);
  return static_cast<double>(spacing);
}

template <class Record>
auto find(std::vector<Record>& records, std::uint32_t id, const char* kind) {
  const auto found = std::find_if(records.begin(), records.end(),
                                  [&](const Record& record) { return record.id.value == id; });
  if (found == records.end()) throw_stale(kind, id);
  return found;
}

}  // namespace

EmitterId World::add_emitter(ObjectId fluid, const Emitter& emitter) {
  WorldState& world = state();
  const CallScope call(*world.calls, "add_emitter");
  const Object& object = world.object(fluid);
  const std::string owner = "an emitter of " + object.name;
  if (!object.traits().flows)
    throw Error(owner + ": it is a " + std::string(kind_name(object.kind)) + ", expected a fluid");
  const double spacing = checked_spacing(emitter, object, owner);
  wake_island(world, object);
  world.flow.emitters.push_back(
      {{world.registry->next_id++}, fluid.value, emitter, layers_before(emitter, spacing, world.time)});
  return world.flow.emitters.back().id;
}

void World::set_emitter(EmitterId id, const Emitter& emitter) {
  WorldState& world = state();
  const CallScope call(*world.calls, "set_emitter");
  EmitterRecord& record = *find(world.flow.emitters, id.value, "emitter");
  const Object& object = world.object({record.fluid});
  const double spacing = checked_spacing(emitter, object, "an emitter of " + object.name);
  record.emitter = emitter;
  record.layers = layers_before(emitter, spacing, world.time);
}

void World::leave_out_covered() {
  WorldState& world = state();
  const CallScope call(*world.calls, "leave_out_covered");
  leave_out_covered_now(world);
}

void World::remove(EmitterId id) {
  WorldState& world = state();
  const CallScope call(*world.calls, "remove(EmitterId)");
  world.flow.emitters.erase(find(world.flow.emitters, id.value, "emitter"));
}

DrainId World::add_drain(const Drain& drain) {
  WorldState& world = state();
  const CallScope call(*world.calls, "add_drain");
  require_valid(drain, "a drain");
  wake_all(world);
  world.flow.drains.push_back({{world.registry->next_id++}, drain, 0});
  return world.flow.drains.back().id;
}

void World::remove(DrainId id) {
  WorldState& world = state();
  const CallScope call(*world.calls, "remove(DrainId)");
  world.flow.drains.erase(find(world.flow.drains, id.value, "drain"));
}

}  // namespace souple
