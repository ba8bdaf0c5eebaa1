#pragma once

#include "souple/fluid/emitter_record.h"
#include "souple/objects/objects_view.h"

#include <cstdint>
#include <span>

namespace souple {

struct ContactTables;
struct FluidSettings;
class Warnings;

/// A world as the fluids' stage reads it.
struct FluidInput {
  ObjectsView objects;
  const ContactTables& contacts;  ///< the colliders; which objects collide with them and with one another
  std::span<const EmitterRecord> emitters;
  const FluidSettings& settings;
  double time = 0;  ///< at the start of the step or substep [s]
  Threads& threads;
  Warnings& warnings;
};

/// The air around the fluids.
struct FluidAir {
  Vec3f wind{};       ///< m/s
  float density = 0;  ///< kg/m^3
};

/// Input of foam for a step of dt seconds, in addition to FluidInput.
struct FoamInput {
  double dt = 0;
  /// Particles::position and Particles::offset at the start of the step.
  std::span<const Vec4f> start_position, start_offset;
  Vec3f gravity{};         ///< m/s^2
  std::uint64_t seed = 0;  ///< random seed; must differ in each step
};

}  // namespace souple
