#pragma once

#include "souple/fluid/body_friction.h"
#include "souple/fluid/surface_tension.h"
#include "souple/fluid/viscosity.h"
#include "souple/fluid/vorticity.h"

#include <vector>

namespace souple {

class DensitySolver;
struct FluidAir;
struct FluidInput;
struct FluidState;
class FluidStatistics;

/// Forces on the fluids: viscosity, wall friction, surface tension, vorticity confinement, air drag.
class FluidForces {
 public:
  explicit FluidForces(SmoothingShape shape = SmoothingShape::wendland)
      : viscosity_(shape), surface_tension_(shape), vorticity_(shape) {}

  /// Changes the velocities of fluids, and of bodies in contact with them, over a substep of h seconds, after
  /// v = (p - x) / h.
  void apply(const FluidInput& input, const FluidAir& air, float h, FluidState& fluids,
             FluidStatistics& statistics);
  /// The particles, with the velocities after the last `apply`.
  FluidView view(const DensitySolver& solver);

 private:
  void load_velocities(const FluidInput& input, const FluidState& fluids);
  void store_velocities(const FluidInput& input, const FluidState& fluids) const;
  double max_speed() const;
  void apply_forces(const FluidInput& input, const FluidAir& air, float h, FluidState& fluids,
                    FluidStatistics& statistics);
  void find_wall_friction(float h, FluidState& fluids, Threads& threads);
  void find_near_walls(const FluidState& fluids, Threads& threads);
  void apply_surface_tension(const FluidInput& input, float sigma, float h, const FluidState& fluids);
  void apply_adhesion(const FluidInput& input, const FluidState& fluids) const;
  void apply_air(const FluidInput& input, const FluidAir& air, float coefficient, float h,
                 const FluidState& fluids);

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
};

}  // namespace souple
