#pragma once

#include "souple/geometry/adjacency.h"
#include "souple/math/vec4.h"
#include "souple/queries/kept_memory.h"
#include "souple/queries/query_view.h"

#include <cstdint>
#include <span>
#include <vector>

namespace souple {

/// Copy of an object's state in user order, updated on demand.
struct Mirror {
  std::uint64_t version = 0;  ///< QueryView::version of `positions`
  std::uint64_t velocities_version = 0, normals_version = 0, angular_velocities_version = 0;
  KeptPoints positions, velocities, normals, angular_velocities;

  // Data for the normals, built on first use.
  Lists<std::uint32_t> triangles_of;  // per vertex
  std::vector<Vec4f> position_records, area_normals;
};

// Bring a part of an object's mirror up to date and return it. The caller holds Caches::lock.
std::span<const Vec3f> mirrored_positions(const QueryView& view, const Object& object, Mirror& mirror);
std::span<const Vec3f> mirrored_velocities(const QueryView& view, const Object& object, Mirror& mirror);
/// Grains only.
std::span<const Vec3f> mirrored_angular_velocities(const QueryView& view, const Object& object,
                                                   Mirror& mirror);
/// Needs triangles.
std::span<const Vec3f> mirrored_normals(const QueryView& view, const Object& object, Mirror& mirror);

}  // namespace souple
