#pragma once

#include "souple/math/vec3.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace souple {

struct FluidInput;
struct FluidRegistry;

/// Inflow zone: the first spacings in front of a nozzle. As in a pipe, emitted fluid moves straight on with
/// `velocity`, regardless of forces. Without it nothing behind a new layer would bear the pressure of the
/// layers in front.
struct Inflow {
  Vec3d position, direction, velocity;  ///< m, unit, m/s
  double radius = 0, depth = 0;         ///< m

  bool drives(const Vec3d& x, const Vec3d& v) const;
};

/// The fluid particles in the inflow zones of emitters.
class InflowParticles {
 public:
  /// Before a step of dt seconds: finds the candidates among the fluids' particles.
  void begin_step(const FluidInput& input, const FluidRegistry& registry, double dt);
  /// Updates the inflow zones; closed emitters have none.
  void begin_substep(const FluidInput& input, const FluidRegistry& registry);
  /// Whether the k-th particle is kinematic in this substep, which starts with its position x and velocity v.
  /// Several threads may call it at the same time for different k.
  bool update(std::size_t k, const Vec3d& x, const Vec3d& v);

  bool is_inflow(std::size_t k) const { return is_inflow_[k] != 0; }
  /// Velocity of a particle for which is_inflow is true [m/s].
  Vec3f velocity(std::size_t k) const { return Vec3f(inflows_[candidate_emitter_[k] - 1].velocity); }

 private:
  // 0, or 1 + the emitter whose zone it may be in during this step.
  std::vector<std::uint32_t> candidate_emitter_;
  std::vector<std::uint8_t> is_inflow_;  // whether it is in a zone in this substep
  std::vector<Inflow> inflows_;          // per emitter
};

}  // namespace souple
