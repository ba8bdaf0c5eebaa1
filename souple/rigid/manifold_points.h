#pragma once

#include "souple/rigid/manifold.h"
#include "souple/rigid/manifold_view.h"

namespace souple::manifold {

/// A possible contact point: a point of one core, and its height above a face or plane of the other.
struct ContactPoint {
  Vec3d point{};
  double height = 0;  ///< m
  std::uint32_t feature = 0;
};
using ContactPoints = StackList<ContactPoint, 2 * static_cast<int>(max_face_corners)>;

/// Reduces the points to four that support a body alike: the deepest, the farthest from it, and the two that add the
/// largest areas as seen along the unit vector `normal`. Of several deepest points, whose heights differ by less than
/// `tolerance` [m], the outermost one counts. Keeps the order.
void reduce_to_four(ContactPoints& points, const Vec3d& normal, double tolerance);

/// The same, but keeps the last choice while these points are there, span nearly the area that they did, and no other is
/// deeper by more than `slack` [m]. A body that trembles on many points would lose the impulses of those that change.
void reduce_to_four(ContactPoints& points, const Vec3d& normal, double slack, LastPoints& last);

}  // namespace souple::manifold
