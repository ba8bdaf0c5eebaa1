#pragma once

#include "souple/fluid/emitter.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

// Which particles emitters add to a fluid and drains remove from it.

namespace souple {

struct EmitterRecord;
struct Object;
struct ObjectsView;
class Threads;

/// Depth of the inflow zone in spacings: the distance within which fluid interacts with other fluid.
inline constexpr double inflow_depth = 2;

/// State of a nozzle at a time.
struct Nozzle {
  Vec3d position, direction, velocity;  ///< m, unit, m/s
  std::array<Vec3d, 2> side;            ///< two unit vectors perpendicular to its direction
};
Nozzle nozzle_at(const Emitter& emitter, double t);

/// Whether an emitter or a drain is active at time t, from its start to its end.
inline bool is_open(double start, double end, double t) {
  return t >= start && t < end;
}

/// A particle that an emitter adds.
struct Drop {
  Vec3d position, velocity;  ///< m, m/s
};

/// All layers k that left the nozzle by now, at the time start + k d / speed with the spacing d [m], and have
/// not been added yet. Counts them in the record.
std::vector<Drop> next_drops(EmitterRecord& record, const Vec3d& gravity, double spacing, double now);
/// Per drop: 1 if a particle of a fluid is too near for it, else 0.
std::vector<std::uint8_t> blocked_drops(std::span<const Drop> drops, const ObjectsView& objects,
                                        double spacing);
/// Mean pressure of the fluids within two spacings of a nozzle, beyond that of the depth there [Pa]: mean over the last
/// step, see Fluids::store_pressures. `weight`: of the fluid [N/m^3].
double back_pressure(const Emitter& emitter, const ObjectsView& objects, const Vec3d& weight, double spacing,
                     double now);
/// Number of layers that left before now according to the emitter's start time. They are skipped.
std::uint64_t layers_before(const Emitter& emitter, double spacing, double now);

/// The particles of a fluid that are in a drain: indices within the object, ascending.
std::vector<std::uint32_t> particles_in(const Drain& drain, const Object& fluid, const ObjectsView& objects,
                                        Threads& threads);

}  // namespace souple
