#pragma once

#include <cstdint>

namespace souple {

/// A point of the unit circle.
struct CirclePoint {
  double cosine{1}, sine{0};
};

/// Point `k` of the `n` that divide the unit circle evenly: angle 2 pi k / n, n >= 1, 0 <= k.
/// Exact at the quarter turns, exactly symmetric about the axes and diagonals, and made of sums and products
/// only, so that a built mesh has the same bits with every compiler, C library and processor (libm's sin and
/// cos differ in the last bit between processors with and without fused multiply-add).
CirclePoint circle_point(std::int64_t k, std::int64_t n);

}  // namespace souple
