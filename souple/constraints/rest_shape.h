#pragma once

#include "souple/error.h"
#include "souple/math/mat3.h"

#include <string>

// What the builders of rest states share: lengths and the message for a shape that cannot be one.

namespace souple::detail {

/// The longest distance between two of the points. [m]
template <int n>
double longest_edge(const Vec3d (&x)[n]) {
  double longest = 0;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < i; ++j) longest = std::fmax(longest, length(x[i] - x[j]));
  return longest;
}

/// Throws unless `measure` (an area or a volume) is a sound part of that of a regular shape of this size.
/// Below a millionth of it float positions cannot tell the shape from a flat one.
inline void require_sound_rest_shape(double measure, double regular, const char* what) {
  if (measure > 1e-6 * regular) return;
  throw Error(
      std::string(what) + ": the rest shape is " + (measure < 0 ? "inside out" : "degenerate") +
      " (its area or volume is below a millionth of a regular shape's of this size); remove the element or "
      "mend the mesh");
}

/// Throws unless value is a finite number in [low, high).
inline void require_in(double value, double low, double high, const char* what) {
  if (value >= low && value < high) return;
  throw Error(std::string(what) + " is " + std::to_string(value) + ": expected a number from " +
              std::to_string(low) + " to below " + std::to_string(high));
}

/// Throws unless value is a finite positive number.
inline void require_positive(double value, const char* what) {
  if (value > 0 && std::isfinite(value)) return;
  throw Error(std::string(what) + " is " + std::to_string(value) + ": expected a positive number");
}

}  // namespace souple::detail
