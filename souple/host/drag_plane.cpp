#include "souple/host/drag_plane.h"

#include "souple/error.h"

#include <cmath>

namespace souple::host {

DragPlane::DragPlane(const Vec3f& point, const Ray& pick, const Vec3f& facing)
    : through_(point), normal_(facing == Vec3f{} ? pick.direction : facing), point_(point) {
  if (!is_finite(point) || !is_finite(pick.origin) || !is_finite(pick.direction) || !is_finite(facing))
    throw Error("drag: the point or the ray is not finite");
  const double size = length(normal_);
  if (!(size > 0)) throw Error("drag: the ray has no direction");
  normal_ = normal_ / size;
  Vec3d at;
  if (meet(pick, at)) offset_ = through_ - at;
}

const Vec3f& DragPlane::drag(const Ray& ray) {
  Vec3d at;
  if (meet(ray, at)) point_ = Vec3f(at + offset_);
  return point_;
}

bool DragPlane::meet(const Ray& ray, Vec3d& at) const {
  // Rays almost parallel to the plane would send the point to the horizon: beyond about 89 degrees it stays.
  constexpr double grazing = 0.02;
  const Vec3d origin(ray.origin), direction(ray.direction);
  const double slope = dot(direction, normal_), distance = dot(through_ - origin, normal_) / slope;
  if (!(std::abs(slope) > grazing * length(direction)) || !(distance > 0)) return false;
  at = origin + direction * distance;
  return is_finite(at);
}

}  // namespace souple::host
