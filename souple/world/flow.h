#pragma once

#include "souple/fluid/emitter.h"

#include <array>
#include <cstdint>
#include <string_view>

// Particle counts of fluids. A fluid's object has a capacity of `capacity` particles. The first of them,
// [begin, end), exist. The others have no mass and are in no use.

namespace souple {

struct Object;
struct WorldState;

struct EmitterRecord {
  EmitterId id;
  std::uint32_t fluid = 0;  ///< object id
  Emitter emitter;
  std::uint64_t layers = 0;  ///< number of layers that were added or held back
};

struct DrainRecord {
  DrainId id;
  Drain drain;
  double credit = 0;  ///< particles that the drain may remove
};

/// Throw Error with a message that starts with `owner`.
void validate(const Emitter& emitter, std::string_view owner);
void validate(const Drain& drain, std::string_view owner);
/// Throws Error if a layer would have too many particles.
void require_layer_size(const Emitter& emitter, float spacing, std::string_view owner);
/// Number of layers that left before now according to the emitter's start time. They are skipped.
std::uint64_t layers_before(const WorldState& world, const Object& fluid, const Emitter& emitter);

/// Before a step of dt seconds: removes the particles in drains, then adds the layers of emitters up to now.
void update_flow(WorldState& world, double dt);

/// State of a nozzle at a time.
struct Nozzle {
  Vec3d position, direction, velocity;  ///< m, unit, m/s
  std::array<Vec3d, 2> side;            ///< two unit vectors perpendicular to its direction
};
Nozzle nozzle_at(const Emitter& emitter, double t);

/// Sets the particle count of a fluid, at most its capacity; new particles are at the origin.
void set_count(WorldState& world, Object& fluid, std::uint32_t count);

}  // namespace souple
