#include "souple/world/arrivals.h"

#include "souple/objects/checks.h"
#include "souple/objects/collider_record.h"
#include "souple/objects/object.h"
#include "souple/world/call_scope.h"
#include "souple/world/contact_state.h"
#include "souple/world/impl.h"
#include "souple/world/sleeping.h"
#include "souple/world/world.h"

#include <algorithm>

#include <fmt/core.h>

// Colliders and pins that arrive at a pose at the end of the next step.

namespace souple {

Transform Arrival::at(double time) const {
  if (!(length > 0)) return from;
  return interpolate(from, to, std::clamp((time - start) / length, 0.0, 1.0));
}

void begin_arrivals(WorldState& world, double dt) {
  world.current.start = world.time;
  world.current.length = dt;
  for (ColliderRecord& record : world.colliders)
    if (record.arrival) record.arrival->start = world.time, record.arrival->length = dt;
  for (const auto& object : world.objects)
    for (PinnedParticle& pin : object->pins)
      if (pin.arrival) pin.from = world.particles.exact_position(object->begin + pin.particle);
}

void end_arrivals(WorldState& world, bool made) {
  for (ColliderRecord& record : world.colliders) {
    if (!record.arrival) continue;
    if (made) record.arrival->from = record.arrival->to;
    record.arrival->length = 0;
  }
  for (const auto& object : world.objects)
    for (PinnedParticle& pin : object->pins)
      if (made) pin.arrival.reset();
}

namespace {

/// Uses an arrival as the motion of a collider, in the contact tables too: nothing else changes.
void arrive(WorldState& world, ColliderRecord& record) {
  record.arrival = std::make_shared<Arrival>();
  record.arrival->from = record.options.motion.at(world.time);
  record.given = record.options.motion;
  record.options.motion =
      ColliderMotion::callback([arrival = record.arrival](double time) { return arrival->at(time); });
  const auto index = static_cast<std::size_t>(&record - world.colliders.data());
  if (!world.dirty.tables) world.contact->tables.colliders[index].motion = record.options.motion;
}

}  // namespace

void place_collider(WorldState& world, ColliderRecord& record, const Transform& pose) {
  if (!record.arrival) arrive(world, record);
  record.arrival->from = record.arrival->to = pose;
}

void World::move_collider(ColliderId id, const Transform& pose) {
  WorldState& world = state();
  const CallScope call(*world.calls, "move_collider");
  ColliderRecord& record = world.collider(id);
  validate(pose, record.options.name);
  if (!record.arrival) arrive(world, record);
  record.arrival->to = {pose.translation, normalized(pose.rotation), 1};
}

namespace {

PinnedParticle& pin_of(Object& object, std::uint32_t particle, std::uint32_t vertex) {
  std::uint32_t& guess = object.per_particle.pin_guess[particle];
  if (guess < object.pins.size() && object.pins[guess].particle == particle) return object.pins[guess];
  const auto found =
      std::lower_bound(object.pins.begin(), object.pins.end(), particle,
                       [](const PinnedParticle& p, std::uint32_t i) { return p.particle < i; });
  if (found == object.pins.end() || found->particle != particle)
    throw Error(fmt::format("move_pins: vertex {} of {} is not pinned; pin it first", vertex, object.name));
  guess = static_cast<std::uint32_t>(found - object.pins.begin());
  return *found;
}

/// Calls f(pin) for the pins of vertices; throws before the first call if one is not pinned.
template <class Function>
void for_each_pin(WorldState& world, Object& object, std::span<const std::uint32_t> vertices,
                  const Function& f) {
  object.per_particle.pin_guess.resize(object.particle_count());
  for (const bool check : {true, false})
    for (std::size_t k = 0; k < vertices.size(); ++k) {
      if (vertices[k] >= object.vertex_count())
        throw Error(fmt::format("move_pins: {} has {} vertices, but no vertex {}", object.name,
                                object.vertex_count(), vertices[k]));
      if (!object.embedding) {
        PinnedParticle& pin = pin_of(object, object.particle_of[vertices[k]], vertices[k]);
        if (!check) f(k, pin);
      } else {
        for (const std::uint32_t particle : object.embedding->vertices[vertices[k]]) {
          PinnedParticle& pin = pin_of(object, particle, vertices[k]);
          if (!check) f(k, pin);
        }
      }
    }
  wake_island(world, object);
}

}  // namespace

void World::move_pins(ObjectId id, const Selector& selector, const Transform& motion) {
  WorldState& world = state();
  const CallScope call(*world.calls, "move_pins");
  Object& object = world.object(id);
  validate(motion, object.name);
  for_each_pin(world, object, select(id, selector), [&](std::size_t, PinnedParticle& pin) {
    pin.arrival = rotate(motion.rotation, pin.pinned_at) + motion.translation;
    pin.target.reset();
  });
}

void World::move_pins(ObjectId id, std::span<const std::uint32_t> vertices,
                      std::span<const Vec3f> positions) {
  WorldState& world = state();
  const CallScope call(*world.calls, "move_pins");
  Object& object = world.object(id);
  if (vertices.size() != positions.size())
    throw Error(fmt::format("move_pins: {} vertices of {} and {} positions; expected as many",
                            vertices.size(), object.name, positions.size()));
  for (const Vec3f& x : positions) require_within("move_pins", "a position", Vec3d(x), range::coordinate);
  for_each_pin(world, object, vertices, [&](std::size_t k, PinnedParticle& pin) {
    pin.arrival = Vec3d(positions[k]) + pin.offset;
    pin.target.reset();
  });
}

}  // namespace souple
