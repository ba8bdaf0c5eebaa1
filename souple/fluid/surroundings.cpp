#include "souple/fluid/surroundings.h"

namespace souple {

namespace {

Smoothing::Wall wall_of(const NearPlane& plane, const Vec3f& x, const Smoothing& smoothing) {
  return smoothing.wall(dot(plane.normal, x) - plane.offset);
}

}  // namespace

BoundarySums sum_of(std::span<const NearPlane> planes, const Vec3f& x, const Smoothing& smoothing) {
  BoundarySums sums;
  float left = 1;
  for (const NearPlane& plane : planes) {
    const Smoothing::Wall wall = wall_of(plane, x, smoothing);
    sums.slope = sums.slope * (1 - wall.value) + plane.normal * (wall.slope * left);
    left *= 1 - wall.value;
  }
  sums.value = 1 - left;
  return sums;
}

Vec3f share_of(std::size_t plane, std::span<const NearPlane> planes, const Vec3f& x,
               const Smoothing& smoothing) {
  float left = 1;
  for (std::size_t k = 0; k < planes.size(); ++k)
    if (k != plane) left *= 1 - wall_of(planes[k], x, smoothing).value;
  return planes[plane].normal * (wall_of(planes[plane], x, smoothing).slope * left);
}

}  // namespace souple
