#include "souple/fluid/local_boundary.h"

namespace souple {

BoundarySums sample_planes(std::span<BoundaryPlane> planes, const Vec3f& x, const Smoothing& smoothing) {
  BoundarySums sums;
  float left = 1;
  for (std::size_t k = 0; k < planes.size(); ++k) {
    BoundaryPlane& plane = planes[k];
    const Smoothing::Wall wall = smoothing.wall(dot(plane.normal, x) - plane.offset);
    plane.slope = plane.normal * (wall.slope * left);
    for (std::size_t j = 0; j < k; ++j) planes[j].slope = planes[j].slope * (1 - wall.value);
    left *= 1 - wall.value;
  }
  for (const BoundaryPlane& plane : planes) sums.slope += plane.slope;
  sums.value = 1 - left;
  return sums;
}

}  // namespace souple
