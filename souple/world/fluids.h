#pragma once

#include "souple/fluid/body_friction.h"
#include "souple/fluid/fluid_bodies.h"
#include "souple/fluid/fluid_walls.h"
#include "souple/fluid/sub_resolution_bodies.h"
#include "souple/fluid/surface_tension.h"
#include "souple/fluid/viscosity.h"
#include "souple/fluid/vorticity.h"
#include "souple/solver/projector.h"
#include "souple/world/fluid_foam.h"
#include "souple/world/fluid_registry.h"
#include "souple/world/fluid_statistics.h"
#include "souple/world/inflow_particles.h"

#include <cstdint>
#include <memory>
#include <vector>

namespace souple {

struct WorldState;

/// The fluids of a world. One density solver handles all of them: their particles have the same spacing.
class Fluids {
 public:
  /// To be called after objects are added, removed or changed.
  void build(const WorldState& world) { registry_.find_bodies(world, bodies_, sub_resolution_bodies_); }
  /// Finds the current particles. Reuses nothing of the last step.
  void begin_step(WorldState& world, double dt);
  bool none() const { return registry_.particle.empty(); }
  /// Moves predicted particles until no fluid is compressed.
  void solve_incompressibility(WorldState& world, const Substep& substep);
  /// Forces on velocities, after v = (p - x) / h.
  void update_velocities(WorldState& world, const Substep& substep);
  /// Spray, foam and bubbles, after the last substep of a step of dt seconds that started at `time`.
  void step_foam(WorldState& world, double time, double dt);
  const FluidFoam& foam() const { return foam_; }
  FluidFoam& foam() { return foam_; }
  /// Results of the step.
  FluidReport report() const;
  /// Pressure of a world's particle, mean over the last step [Pa]; 0 if it belongs to no fluid.
  float pressure(std::uint32_t particle) const;
  /// Force on a collider by its index, mean over the last step [N].
  Vec3d force(std::size_t collider) const { return statistics_.force(collider); }

 private:
  void choose_solver(const WorldState& world);
  void set_positions(WorldState& world, float h, Threads& threads);
  void sample_boundary(Threads& threads);
  void apply_corrections(const ParticleView& particles, Threads& threads);
  void keep_out_of_bodies(const ParticleView& particles) const;
  void find_wall_friction(float h, Threads& threads);
  void find_near_walls(Threads& threads);
  void apply_adhesion(WorldState& world);
  void apply_forces(WorldState& world, const Substep& substep);
  FluidView view();

  FluidRegistry registry_;
  std::unique_ptr<DensitySolver> solver_;
  float spacing_ = 0;  // of solver_
  DensitySolver::Options options_{};
  LocalBoundary local_boundary_;
  FluidWalls walls_;
  FluidBodies bodies_;
  SubResolutionBodies sub_resolution_bodies_;
  InflowParticles inflow_;
  Vec3d origin_{};                // of the fluids' positions [m]
  std::vector<Vec4f> positions_;  // per fluid particle: x, y, z from the origin, and inverse mass
  std::vector<Vec3f> start_;      // per fluid particle: position at the start of the substep
  // By sorted index.
  std::vector<Vec4f> velocity_;       // and viscosity in w; one more entry, 0
  std::vector<Vec4f> wall_friction_;  // see WallFriction
  std::vector<NearWall> near_walls_;
  std::vector<float> density_ratio_;  // V sum W
  std::vector<float> wind_exposure_;  // share of the wind's velocity
  Viscosity viscosity_;
  BodyFriction body_friction_;
  SurfaceTension surface_tension_;
  VorticityConfinement vorticity_;
  FluidFoam::Source foam_source_;
  FluidFoam foam_;
  FluidStatistics statistics_;
};

}  // namespace souple
