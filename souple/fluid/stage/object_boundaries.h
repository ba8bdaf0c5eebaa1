#pragma once

#include "souple/fluid/fluid_bodies.h"
#include "souple/fluid/sub_resolution_bodies.h"

#include <cstdint>
#include <vector>

namespace souple {

/// The objects of a world as its fluids meet them: walls, or bodies too small to be walls.
struct ObjectBoundaries {
  std::vector<BoundaryMesh> meshes;
  std::vector<SubResolutionBody> bodies;
  // Object indices.
  std::vector<std::uint32_t> with_mesh;       ///< of each mesh
  std::vector<std::uint32_t> sub_resolution;  ///< of each SubResolutionBody::object
};

}  // namespace souple
