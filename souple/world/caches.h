#pragma once

#include "souple/geometry/adjacency.h"
#include "souple/math/vec4.h"
#include "souple/world/query_index.h"

#include <cstdint>
#include <map>
#include <mutex>
#include <vector>

namespace souple {

/// Copy of an object's state in user order, updated on demand.
struct Mirror {
  std::uint64_t version = 0;  ///< WorldState::version of `positions`
  std::uint64_t velocities_version = 0, normals_version = 0, angular_velocities_version = 0;
  std::vector<Vec3f> positions, velocities, normals, angular_velocities;

  // Data for the normals, built on first use.
  VertexTriangles triangles_of;
  std::vector<Vec4f> position_records, area_normals;
};

/// What const functions of a world fill on demand. They hold the lock meanwhile.
struct Caches {
  std::map<std::uint32_t, Mirror> mirrors;  ///< by object id
  QueryIndex query_index;
  std::mutex lock;  ///< also of ContactState::events
};

}  // namespace souple
