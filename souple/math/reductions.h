#pragma once

#include <cstddef>
#include <cstring>

// Sums and maxima of many floats in a fixed order: the same bits for any register width. Number k goes to the
// (k mod 16)-th of sixteen partial results, which are then combined as a tree.

namespace souple {

namespace detail {

typedef float FourFloats __attribute__((vector_size(16)));  // NOLINT(modernize-use-using)

template <class Combine>
float reduce(const float* values, std::size_t n, const Combine& combine) {
  FourFloats partial[4]{}, next[4];
  std::size_t i = 0;
  for (; i + 16 <= n; i += 16) {
    std::memcpy(next, values + i, sizeof next);
    for (int k = 0; k < 4; ++k) partial[k] = combine(partial[k], next[k]);
  }
  float rest[16] = {};
  for (std::size_t k = 0; i + k < n; ++k) rest[k] = values[i + k];
  std::memcpy(next, rest, sizeof next);
  for (int k = 0; k < 4; ++k) partial[k] = combine(partial[k], next[k]);
  const FourFloats four = combine(combine(partial[0], partial[2]), combine(partial[1], partial[3]));
  const FourFloats two = combine(four, FourFloats{four[2], four[3], 0, 0});
  return combine(two, FourFloats{two[1], 0, 0, 0})[0];
}

}  // namespace detail

inline float sum_of(const float* values, std::size_t n) {
  return detail::reduce(values, n, [](auto a, auto b) { return a + b; });
}

/// The largest value, or 0 when all are below 0. NaNs are left out.
inline float largest_of(const float* values, std::size_t n) {
  return detail::reduce(values, n, [](auto a, auto b) { return b > a ? b : a; });
}

}  // namespace souple
