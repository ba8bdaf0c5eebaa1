#pragma once

#include "souple/fluid/fluid_bodies.h"
#include "souple/fluid/sub_resolution_bodies.h"
#include "souple/world/materials.h"

#include <cstdint>
#include <vector>

namespace souple {

struct WorldState;

/// Which fluids a world has, which of its particles are theirs, and what they meet.
struct FluidRegistry {
  std::vector<std::uint32_t> particle;  ///< of each of the fluids' particles, the world's; ascending
  std::vector<std::uint16_t> fluid;     ///< and which fluid it is of
  // Of each fluid.
  std::vector<FluidMaterial> materials;
  std::vector<float> viscosities;  ///< Pa s
  // Objects.
  std::vector<std::uint32_t> with_boundary;   ///< that are bodies to fluids
  std::vector<std::uint32_t> sub_resolution;  ///< that are made of small bodies
  // Of each fluid and then each collider, skinned object, small object: whether they meet.
  std::vector<std::uint8_t> collides_with_collider, collides_with_body, collides_with_sub_resolution;

  /// Which objects are skinned or small, and how fluids feel them: after objects came, went or changed.
  void find_bodies(const WorldState& world, FluidBodies& bodies, SubResolutionBodies& sub_resolution_bodies);
  /// All the others: before each step.
  void find_particles(const WorldState& world);
};

}  // namespace souple
