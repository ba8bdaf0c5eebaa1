#pragma once

#include "souple/math/vec3.h"

#include <cstdint>
#include <span>
#include <vector>

namespace souple {

/// Sum of the lengths of a polyline's segments [m].
double polyline_length(std::span<const Vec3d> points);

/// segments + 1 points at equal distances along the polyline; the first and the last are its ends.
std::vector<Vec3d> resample_polyline(std::span<const Vec3d> points, std::uint32_t segments);

}  // namespace souple
