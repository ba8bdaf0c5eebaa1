#pragma once

#include "souple/world/emitter.h"

#include <array>
#include <cstdint>
#include <string_view>

// How fluids get more particles and lose some. A fluid's object has room for `capacity` particles, the first
// ones of which are there: [begin, end). The others have no mass and belong to nobody.

namespace souple {

struct Object;
struct WorldState;

struct EmitterRecord {
  EmitterId id;
  std::uint32_t fluid = 0;  ///< an object's id
  Emitter emitter;
  std::uint64_t layers = 0;  ///< that have come or were held back
};

struct DrainRecord {
  DrainId id;
  Drain drain;
  double credit = 0;  ///< particles that it may take
};

/// Throw Error; `owner` begins the message.
void validate(const Emitter& emitter, std::string_view owner);
void validate(const Drain& drain, std::string_view owner);
/// Throws Error where a layer would have too many particles.
void require_layer_size(const Emitter& emitter, float spacing, std::string_view owner);
/// Layers of an emitter that would have come by now, had it been there from its start on: they never do.
std::uint64_t layers_before(const WorldState& world, const Object& fluid, const Emitter& emitter);

/// What has come out of emitters by now is there, what is in drains is gone: before a step of dt seconds.
void update_flow(WorldState& world, double dt);

/// A nozzle at a moment.
struct Nozzle {
  Vec3d position, direction, velocity;  ///< m, unit, m/s
  std::array<Vec3d, 2> side;            ///< two unit vectors across its direction
};
Nozzle nozzle_at(const Emitter& emitter, double t);

/// A fluid has so many particles from now on, at most its capacity; new ones are at the origin.
void set_count(WorldState& world, Object& fluid, std::uint32_t count);

}  // namespace souple
