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

/// Reduces the points to four that support a body alike. These are the deepest point, the farthest from it, and the two
/// that add the largest areas as seen along the unit vector `normal`. Points whose depths differ by less than
/// `tolerance` [m] count as equally deep, and the outermost of them is taken. Keeps the order.
void reduce_to_four(ContactPoints& points, const Vec3d& normal, double tolerance);

/// Keeps the last choice while these points exist, span nearly the earlier area, and no other point is deeper by more
/// than `slack` [m]. Otherwise a body that trembles on many points would lose the impulses of the points that change.
void reduce_to_four(ContactPoints& points, const Vec3d& normal, double slack, LastPoints& last);

}  // namespace souple::manifold
