#include "souple/rigid/rigid_shape.h"

#include <limits>

namespace souple {
namespace {

double radius_about_origin(const ShapeBounds& box) {
  Vec3d farthest;
  for (int k = 0; k < 3; ++k) farthest[k] = max(-box.lo[k], box.hi[k]);
  return length(farthest);
}

}  // namespace

double RigidShape::radius() const {
  if (collider) return bounding_ball(*collider).radius + length(bounding_ball(*collider).center);
  if (mesh) return radius_about_origin(mesh->bounds());
  double result = 0;
  for (const ConvexShape& part : parts) result = max(result, part.bounding_radius);
  return result;
}

double RigidShape::inner_radius() const {
  if (parts.empty()) return std::numeric_limits<double>::infinity();
  return parts.front().inner_radius + parts.front().radius;
}

}  // namespace souple
