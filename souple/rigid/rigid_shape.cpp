#include "souple/rigid/rigid_shape.h"

#include <limits>

namespace souple {

double RigidShape::radius() const {
  if (collider) return bounding_ball(*collider).radius + length(bounding_ball(*collider).center);
  double result = 0;
  for (const ConvexShape& part : parts) result = max(result, part.bounding_radius);
  return result;
}

double RigidShape::inner_radius() const {
  if (collider || parts.empty()) return std::numeric_limits<double>::infinity();
  return parts.front().inner_radius + parts.front().radius;
}

}  // namespace souple
