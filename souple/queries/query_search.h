#pragma once

#include "souple/broad_phase/bounds.h"
#include "souple/contacts/contact_material.h"
#include "souple/objects/collider_record.h"
#include "souple/objects/object.h"
#include "souple/queries/query.h"

#include <algorithm>
#include <cmath>
#include <limits>

// Functions that queries share.

namespace souple {

inline constexpr double query_infinity = std::numeric_limits<double>::infinity();

/// Boxes grow by this part of the distances in play, far more than the rounding of tests in double precision. So a tree
/// finds every element that testing all would find.
inline constexpr double query_rounding = 1e-9;

/// Largest distance along an axis between a point and a point of the box.
inline double reach(const Bounds& box, const Vec3d& p) {
  double most = 0;
  for (int k = 0; k < 3; ++k)
    most = std::max({most, std::fabs(static_cast<double>(box.lo[k]) - p[k]),
                     std::fabs(static_cast<double>(box.hi[k]) - p[k])});
  return most;
}

inline bool passes_groups(std::uint32_t groups, const QueryFilter& filter) {
  return filter.groups == ~0u || (groups & filter.groups) != 0;
}

inline bool passes(const Object& object, const QueryFilter& filter) {
  const auto holds = [&](const std::vector<ObjectId>& ids) {
    return std::find(ids.begin(), ids.end(), object.id) != ids.end();
  };
  return filter.objects && (filter.kinds & kind_bit(object.kind)) != 0 &&
         passes_groups(object.collision.filter.groups, filter) &&
         (filter.only.empty() || holds(filter.only)) && !holds(filter.except);
}

inline bool passes(const ColliderRecord& record, const QueryFilter& filter) {
  const std::vector<ColliderId>& ids = filter.except_colliders;
  return filter.colliders && (filter.sensors || !record.options.sensor) &&
         passes_groups(record.options.collision_groups, filter) &&
         std::find(ids.begin(), ids.end(), record.id) == ids.end();
}

/// A pose as a frame for points and directions; its scale is 1.
struct Frame {
  Transform pose;

  Vec3d to_local(const Vec3d& world) const {
    return rotate(conjugate(pose.rotation), world - pose.translation);
  }
  Vec3d direction_to_local(const Vec3d& world) const { return rotate(conjugate(pose.rotation), world); }
};

}  // namespace souple
