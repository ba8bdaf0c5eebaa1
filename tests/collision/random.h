#pragma once

#include "souple/math/vec3.h"

#include <cstdint>

namespace souple::test {

/// A small random number generator (xorshift64*): the same numbers on every platform.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed * 2685821657736338717u + 1) {}
  std::uint64_t bits() {
    state_ ^= state_ >> 12;
    state_ ^= state_ << 25;
    state_ ^= state_ >> 27;
    return state_ * 2685821657736338717u;
  }
  /// Uniform in [0, 1).
  double unit() { return double(bits() >> 11) / 9007199254740992.0; }
  /// Uniform in [lo, hi).
  double uniform(double lo, double hi) { return lo + (hi - lo) * unit(); }
  Vec3d point(double lo, double hi) {
    const double x = uniform(lo, hi), y = uniform(lo, hi), z = uniform(lo, hi);
    return {x, y, z};
  }
  /// Uniform in [-1, 1) along each axis.
  Vec3d vector() { return point(-1, 1); }

 private:
  std::uint64_t state_;
};

}  // namespace souple::test
