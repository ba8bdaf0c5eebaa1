#pragma once

#include "souple/fluid/density_solver.h"
#include "souple/fluid/fluid_bodies.h"
#include "souple/fluid/fluid_walls.h"
#include "souple/fluid/local_boundary.h"
#include "souple/fluid/stage/fluid_registry.h"
#include "souple/fluid/stage/inflow_particles.h"
#include "souple/fluid/sub_resolution_bodies.h"

#include <memory>

// Data that the parts of the fluids' stage share: pressure, forces, foam.

namespace souple {

/// Surroundings of the fluids: colliders, objects that are walls, and bodies too small to be walls.
struct FluidBoundary {
  LocalBoundary local;
  FluidWalls walls;
  FluidBodies bodies;
  SubResolutionBodies sub_resolution;
};

/// The fluids of a world. One density solver handles all of them: their particles have the same spacing.
struct FluidState {
  FluidRegistry registry;
  std::unique_ptr<DensitySolver> solver;
  float spacing = 0;  ///< of the solver [m]
  FluidBoundary boundary;
  InflowParticles inflow;
  Vec3d origin{};  ///< of the fluids' positions [m]
};

}  // namespace souple
