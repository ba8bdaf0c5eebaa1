#pragma once

#include "souple/math/limits.h"
#include "souple/math/transform.h"

#include <initializer_list>
#include <limits>
#include <string_view>

// Checks of user input. All throw Error with the owner, the field, its value and the expected range.

namespace souple {

/// A field and its valid range; `hi` is excluded if `open`.
struct Check {
  const char* field;
  double value, lo, hi;
  bool open = false;
};

/// Ends of ranges.
namespace range {
inline constexpr double positive = 1e-30;  ///< the lowest for numbers that must be positive
inline constexpr double finite = 1e30;     ///< the highest for numbers without another limit
inline constexpr double infinite = std::numeric_limits<double>::infinity();
}  // namespace range

void check_all(std::string_view owner, std::initializer_list<Check> checks);
void require_finite(std::string_view owner, const char* field, const Vec3f& v);
/// Throws unless each component is a number of at most `limit`, e.g. range::coordinate.
void require_within(std::string_view owner, const char* field, const Vec3d& v, double limit);
void validate(const Transform& transform, std::string_view owner);

}  // namespace souple
