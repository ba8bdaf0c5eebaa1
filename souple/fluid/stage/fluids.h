#pragma once

#include "souple/fluid/fluid_report.h"
#include "souple/math/vec3.h"
#include "souple/math/vec4.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

namespace souple {

struct FluidAir;
class FluidFoam;
struct FluidInput;
struct FoamInput;
struct ObjectsView;
struct Substep;

/// The fluids' stage: all fluids of a world, in a step. Nothing but foam is kept from one step to the next.
///
/// Calls in a step of dt seconds:
///   begin_step(input, dt)
///   for each substep:
///     solve_incompressibility(input, substep)     after prediction
///     update_velocities(input, air, substep)      after v = (p - x) / h
///   step_foam(input, foam_input)                  with the time at which the step started
///   report(), pressure(), force(), foam()
class Fluids {
 public:
  Fluids();
  ~Fluids();
  Fluids(const Fluids&) = delete;
  Fluids& operator=(const Fluids&) = delete;

  /// To be called after objects are added, removed or changed.
  void build(const ObjectsView& objects);
  /// Finds the current particles. Reuses nothing of the last step.
  void begin_step(const FluidInput& input, double dt);
  bool none() const;
  /// Moves particles until no fluid is compressed at the substep's start, without changing velocities. Water that begins too
  /// near a solid would be thrown off at up to 10 m/s. To be called before solve_incompressibility.
  void settle(const FluidInput& input, const Substep& substep);
  /// Moves predicted particles until no fluid is compressed.
  void solve_incompressibility(const FluidInput& input, const Substep& substep);
  /// Forces on velocities, after v = (p - x) / h.
  void update_velocities(const FluidInput& input, const FluidAir& air, const Substep& substep);
  /// Spray, foam and bubbles, after the last substep.
  void step_foam(const FluidInput& input, const FoamInput& foam_input);
  const FluidFoam& foam() const;
  FluidFoam& foam();
  /// Results of the step.
  FluidReport report() const;
  /// Pressure of a world's particle, mean over the last step [Pa]; 0 if it belongs to no fluid.
  float pressure(std::uint32_t particle) const;
  /// Writes these pressures to the fourth numbers of the velocities of the world's particles.
  void store_pressures(std::span<Vec4f> velocity) const;
  /// Force on a collider by its index, mean over the last step [N].
  Vec3d force(std::size_t collider) const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace souple
