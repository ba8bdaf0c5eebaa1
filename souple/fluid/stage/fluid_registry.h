#pragma once

#include "souple/objects/materials.h"

#include <cstdint>
#include <vector>

namespace souple {

struct ContactTables;
class FluidBodies;
struct ObjectsView;
class SubResolutionBodies;

/// The fluids of a world, their particles, and the objects with which they collide.
struct FluidRegistry {
  /// The object of a fluid.
  struct Source {
    std::uint32_t id, begin, end;  ///< its handle, and the range of its particles
  };

  std::vector<std::uint32_t> particle;  ///< per fluid particle: index in the world; ascending
  std::vector<std::uint16_t> fluid;     ///< per fluid particle: its fluid
  // Per fluid.
  std::vector<Source> sources;
  std::vector<FluidMaterial> materials;
  std::vector<float> viscosities;     ///< Pa s
  std::vector<float> wind_exposures;  ///< share of the wind's velocity
  // Object indices.
  std::vector<std::uint32_t> with_boundary;   ///< objects with a boundary mesh
  std::vector<std::uint32_t> sub_resolution;  ///< objects made of sub-resolution bodies
  // Per fluid, and within it per collider, per object with a boundary mesh, per object of sub-resolution
  // bodies: whether they collide.
  std::vector<std::uint8_t> collides_with_collider, collides_with_body, collides_with_sub_resolution;

  /// Finds the objects with a boundary mesh or sub-resolution bodies and registers them. To be called after
  /// objects are added, removed or changed.
  void find_bodies(const ObjectsView& objects, FluidBodies& bodies,
                   SubResolutionBodies& sub_resolution_bodies);
  /// Finds the fluids, their particles and their collisions. To be called before each step.
  void find_particles(const ObjectsView& objects, const ContactTables& contacts);
  /// The fluid with this handle, which must exist.
  std::size_t find(std::uint32_t id) const;
};

}  // namespace souple
