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

/// The fluids of a world, all of them in one density solver: their particles have one spacing.
class Fluids {
 public:
  /// After objects came, went or changed.
  void build(const WorldState& world) { registry_.find_bodies(world, bodies_, sub_resolution_bodies_); }
  /// Finds out which particles there are. Nothing of the last step is used again.
  void begin_step(WorldState& world, double dt);
  bool none() const { return registry_.particle.empty(); }
  /// Pushes predicted particles apart until no fluid is compressed.
  void solve_incompressibility(WorldState& world, const Substep& substep);
  /// After v = (p - x) / h.
  void update_velocities(WorldState& world, const Substep& substep);
  /// Spray, foam and bubbles, after the last substep of a step of dt seconds that began at `time`.
  void step_foam(WorldState& world, double time, double dt);
  const FluidFoam& foam() const { return foam_; }
  FluidFoam& foam() { return foam_; }
  /// What the step did.
  FluidReport report() const;
  /// Of a world's particle, mean of the last step [Pa]. 0 when it is no fluid's.
  float pressure(std::uint32_t particle) const;
  /// On a collider, by its index, mean of the last step [N]
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
  std::vector<Vec4f> positions_;  // x, y, z from the origin and inverse mass
  std::vector<Vec3f> start_;      // where they were when the substep began
  // By place.
  std::vector<Vec4f> velocity_;       // and the viscosity; one more, 0
  std::vector<Vec4f> wall_friction_;  // see WallFriction
  std::vector<NearWall> near_walls_;
  std::vector<float> density_ratio_;  // V sum W
  Viscosity viscosity_;
  BodyFriction body_friction_;
  SurfaceTension surface_tension_;
  VorticityConfinement vorticity_;
  FluidFoam::Source foam_source_;
  FluidFoam foam_;
  FluidStatistics statistics_;
};

}  // namespace souple
