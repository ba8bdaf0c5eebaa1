#pragma once

#include <cstdint>

namespace souple {

/// A point on the unit circle.
struct CirclePoint {
  double cosine{1}, sine{0};
};

/// Point `k` of `n` evenly spaced points on the unit circle: angle 2 pi k / n, n >= 1, k >= 0. Exact at
/// quarter turns and exactly symmetric about the axes and diagonals. Uses sums and products only, so that
/// generated meshes are bitwise equal with every compiler, C library and processor. (sin and cos of libm
/// differ in the last bit between processors with and without fused multiply-add.)
CirclePoint circle_point(std::int64_t k, std::int64_t n);

}  // namespace souple
