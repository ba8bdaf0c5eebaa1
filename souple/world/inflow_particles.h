#pragma once

#include "souple/math/vec3.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace souple {

struct WorldState;

/// Spacings that fluid is led, which is as far as it feels other fluid.
inline constexpr double inflow_depth = 2;

/// The first spacings before a nozzle, as if in a pipe: fluid that leaves goes straight on with `velocity`,
/// whatever pushes it. Without this the layers that come would have nothing behind them that bears the
/// pressure of those before them.
struct Inflow {
  Vec3d position, direction, velocity;  ///< m, unit, m/s
  double radius = 0, depth = 0;         ///< m

  bool drives(const Vec3d& x, const Vec3d& v) const;
};

/// Which of the fluids' particles are in the mouths of emitters.
class InflowParticles {
 public:
  /// Before a step of dt seconds: which of `particles`, ascending numbers of the world's, may be led in it.
  void begin_step(WorldState& world, double dt, std::span<const std::uint32_t> particles);
  /// Where mouths are now; emitters that are shut lead nothing.
  void begin_substep(WorldState& world);
  /// Whether the k-th of the particles is led in this substep, which begins with it at x and its velocity v.
  /// Several threads may call it at a time, for different k.
  bool update(std::size_t k, const Vec3d& x, const Vec3d& v);

  bool is_inflow(std::size_t k) const { return is_inflow_[k] != 0; }
  /// Of one that is led. [m/s]
  Vec3f velocity(std::size_t k) const { return Vec3f(inflows_[candidate_emitter_[k] - 1].velocity); }

 private:
  std::vector<std::uint32_t> candidate_emitter_;  // 0, or 1 + the emitter that may lead it in this step
  std::vector<std::uint8_t> is_inflow_;           // whether one does in this substep
  std::vector<Inflow> inflows_;                   // of the emitters
};

}  // namespace souple
