#pragma once

#include "souple/error.h"
#include "souple/math/mat3.h"

// Lengths and checks for the from_rest and compliance functions of constraint kinds.

namespace souple::detail {

/// Longest distance between two points. [m]
template <int n>
double longest_edge(const Vec3d (&x)[n]) {
  double longest = 0;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < i; ++j) longest = std::fmax(longest, length(x[i] - x[j]));
  return longest;
}

/// Throws Error unless `measure` (an area or a volume) is more than a millionth of `regular`, that of a
/// regular shape of equal size. Below that, float positions cannot distinguish the shape from a flat one.
void require_valid_rest_shape(double measure, double regular, const char* what);

/// Throws Error unless value is a number in [low, high).
void require_in(double value, double low, double high, const char* what);

/// Throws Error unless value is a finite positive number.
void require_positive(double value, const char* what);

}  // namespace souple::detail
