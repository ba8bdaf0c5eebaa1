#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

// The largest numbers that a user may set, and how a coordinate that grew beyond them becomes a cell's.

namespace souple {

namespace range {
/// Where floats are 64 m apart: far beyond what a scene in meters needs, and squared lengths still fit.
inline constexpr double coordinate = 1e9;  ///< m, of each component of a position
inline constexpr double speed = 1e9;       ///< m/s or rad/s, of each component of a velocity
inline constexpr double time = 1e9;        ///< s
}  // namespace range

/// Whether all components are numbers of at most `limit`.
template <class Vec>
bool is_within(const Vec& v, double limit) {
  return std::abs(double(v.x)) <= limit && std::abs(double(v.y)) <= limit && std::abs(double(v.z)) <= limit;
}

/// The cell, the floor, of a coordinate in cells. Those more than 1e9 cells from 0, where a simulation may end up, share
/// the outermost one; NaN is in the lowest.
inline std::int32_t cell_of(double cells) {
  constexpr double outermost = 1e9;
  return cells > -outermost ? static_cast<std::int32_t>(std::min(std::floor(cells), outermost))
                            : -static_cast<std::int32_t>(outermost);
}

}  // namespace souple
