#pragma once

#include "souple/fluid/body_friction.h"
#include "souple/fluid/fluid_bodies.h"
#include "souple/fluid/fluid_walls.h"
#include "souple/fluid/small_bodies.h"
#include "souple/fluid/surface_tension.h"
#include "souple/fluid/viscosity.h"
#include "souple/fluid/vorticity.h"
#include "souple/solver/projector.h"
#include "souple/world/flow.h"
#include "souple/world/fluid_foam.h"
#include "souple/world/materials.h"
#include "souple/world/report.h"

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace souple {

struct WorldState;

/// The fluids of a world, all of them in one density solver: their particles have one spacing.
class Fluids {
 public:
  /// After objects came, went or changed.
  void build(const WorldState& world);
  /// Finds out which particles there are. Nothing of the last step is used again.
  void begin_step(WorldState& world, double dt);
  bool none() const { return particle_.empty(); }
  /// Pushes predicted particles apart until no fluid is compressed.
  void press(WorldState& world, const Substep& substep);
  /// After v = (p - x) / h.
  void update_velocities(WorldState& world, const Substep& substep);
  /// Spray, foam and bubbles, after the last substep of a step of dt seconds that began at `time`.
  void step_foam(WorldState& world, double time, double dt);
  const FluidFoam& foam() const { return foam_; }
  FluidFoam& foam() { return foam_; }
  /// What the step did, averaged over its substeps where that makes sense.
  FluidReport report() const;
  /// Of a world's particle, mean of the last step [Pa]. 0 when it is no fluid's.
  float pressure(std::uint32_t particle) const;
  /// On a collider, by its index, mean of the last step [N]
  Vec3d force(std::size_t collider) const;

 private:
  /// Of a chunk of places.
  struct Noted {
    double errors = 0;
    float largest_error = 0, pressure = 0, coarsest = 0;

    void add(const Noted& other) {
      errors += other.errors;
      largest_error = std::max(largest_error, other.largest_error);
      pressure = std::max(pressure, other.pressure);
      coarsest = std::max(coarsest, other.coarsest);
    }
  };

  void choose_solver(const WorldState& world);
  void find_particles(const WorldState& world);
  void place(WorldState& world, float h, Threads& threads);
  Vec3f mouth_velocity(std::size_t k) const { return Vec3f(mouths_[may_be_led_[k] - 1].velocity); }
  Vec3f lead(const WorldState& world, std::size_t k, const Vec3f& predicted, float h);
  void look_around(Threads& threads);
  void find_wall_friction(float h, Threads& threads);
  void find_near_walls(Threads& threads);
  void pull_bodies(WorldState& world);
  void apply_forces(WorldState& world, const Substep& substep);
  void note(const WorldState& world, const Substep& substep);

  std::unique_ptr<DensitySolver> solver_;
  float spacing_ = 0;  // of solver_
  DensitySolver::Options options_{};
  Surroundings surroundings_;
  FluidWalls walls_;
  FluidBodies bodies_;
  Vec3d origin_{};                         // of the fluids' positions [m]
  std::vector<std::uint32_t> particle_;    // of each of the fluids' particles, the world's
  std::vector<std::uint16_t> fluid_;       // and which fluid it is of
  std::vector<std::uint32_t> may_be_led_;  // 0, or 1 + the emitter that may lead it in this step
  std::vector<std::uint8_t> led_;          // whether one does in this substep
  std::vector<Mouth> mouths_;              // of the emitters
  SmallBodies small_bodies_;
  std::vector<std::uint32_t> objects_;     // of each fluid
  std::vector<FluidMaterial> materials_;   // of each fluid
  std::vector<std::uint8_t> meets_;        // of each fluid and collider
  std::vector<std::uint32_t> skinned_;     // objects that are bodies to fluids
  std::vector<std::uint8_t> feels_;        // of each fluid and body
  std::vector<std::uint32_t> small_;       // objects that are made of small bodies
  std::vector<std::uint8_t> feels_small_;  // of each fluid and these
  std::vector<float> viscosities_;         // of each fluid [Pa s]
  std::vector<Vec4f> placed_;              // x, y, z from the origin and inverse mass
  std::vector<Vec3f> start_;               // where they were when the substep began
  std::vector<Vec4f> velocity_;            // by place, and the viscosity; one more, 0
  std::vector<Vec4f> wall_friction_;       // by place
  std::vector<NearWall> near_walls_;       // the same
  std::vector<float> covered_;             // by place: V sum W
  FluidFoam foam_;
  std::vector<std::uint32_t> foam_particle_;           // by place: particle_
  std::vector<float> foam_share_;                      // the same: how much of the rates it makes
  std::vector<Vec3f> wall_slopes_;                     // the same [1/m]
  std::vector<std::uint8_t> some_meets_, some_feels_;  // of each collider and skin: some fluid does
  Viscosity viscosity_;
  BodyFriction body_friction_;
  SurfaceTension surface_tension_;
  VorticityConfinement vorticity_;
  std::vector<float> pressure_;  // sum over substeps [Pa]
  std::vector<Noted> noted_;
  std::vector<Vec3d> pushed_;  // of each chunk and collider
  std::vector<Vec3d> force_;   // on each collider [N]
  int substeps_ = 0;
  FluidReport report_;
};

}  // namespace souple
