#pragma once

#include "souple/error.h"
#include "souple/math/mat3.h"

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
void require_valid_rest_shape(double measure, double regular, const char* what);

/// Throws unless value is a finite number in [low, high).
void require_in(double value, double low, double high, const char* what);

/// Throws unless value is a finite positive number.
void require_positive(double value, const char* what);

}  // namespace souple::detail
