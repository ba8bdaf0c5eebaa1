#include "souple/fluid/local_boundary.h"

namespace souple {

Smoothing::Wall part_of(const Smoothing::Wall& wall, float share) {
  const float left = 1 - 0.5f * (1 - share) * wall.value;
  return {share * wall.value / left, share * wall.slope / (left * left)};
}

BoundarySums sample_planes(std::span<BoundaryPlane> planes, const Vec3f& x, const Smoothing& smoothing) {
  BoundarySums sums;
  float left = 1;
  for (std::size_t k = 0; k < planes.size(); ++k) {
    BoundaryPlane& plane = planes[k];
    const Smoothing::Wall wall = part_of(smoothing.wall(dot(plane.normal, x) - plane.offset), plane.share);
    plane.slope = plane.normal * (wall.slope * left);
    for (std::size_t j = 0; j < k; ++j) planes[j].slope = planes[j].slope * (1 - wall.value);
    left *= 1 - wall.value;
  }
  for (const BoundaryPlane& plane : planes) sums.slope += plane.slope;
  sums.value = 1 - left;
  return sums;
}

}  // namespace souple
