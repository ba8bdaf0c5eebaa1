#pragma once

#include "souple/world/emitter.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

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
void require_sound_layer(const Emitter& emitter, float spacing, std::string_view owner);
/// Layers of an emitter that would have come by now, had it been there from its start on: they never do.
std::uint64_t layers_before(const WorldState& world, const Object& fluid, const Emitter& emitter);

/// What has come out of emitters by now is there, what is in drains is gone: before a step of dt seconds.
void let_flow(WorldState& world, double dt);

/// The first spacings before a nozzle, as if in a pipe: fluid that leaves goes straight on with `velocity`,
/// whatever pushes it. Without this the layers that come would have nothing behind them that bears the
/// pressure of those before them.
struct Mouth {
  Vec3d position, direction, velocity;  ///< m, unit, m/s
  double radius = 0, depth = 0;         ///< m

  bool leads(const Vec3d& x, const Vec3d& v) const;
};

/// Of each emitter at the time t; those that are shut lead nothing.
std::vector<Mouth> mouths_at(const WorldState& world, double t);

/// For each of `particles`, ascending numbers of the world's: 0, or 1 + the emitter that may lead it in a
/// step of dt seconds.
void find_led(const WorldState& world, double dt, std::span<const std::uint32_t> particles,
              std::vector<std::uint32_t>& led);

/// A fluid has so many particles from now on, at most its capacity; new ones are at the origin.
void set_count(WorldState& world, Object& fluid, std::uint32_t count);

}  // namespace souple
