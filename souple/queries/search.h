#pragma once

#include "souple/queries/query.h"
#include "souple/queries/query_view.h"

#include <vector>

// Rays, swept balls and closest points, as World has them. All throw Error if a value is not finite.

namespace souple {

Hit ray_cast(const QueryView& view, const Vec3f& origin, const Vec3f& direction, double max_distance,
             const QueryFilter& filter);
std::vector<Hit> ray_cast_all(const QueryView& view, const Vec3f& origin, const Vec3f& direction,
                              double max_distance, const QueryFilter& filter);
Hit sphere_cast(const QueryView& view, const Vec3f& origin, float radius, const Vec3f& direction,
                double max_distance, const QueryFilter& filter);
Hit closest_point(const QueryView& view, const Vec3f& point, const QueryFilter& filter);

}  // namespace souple
