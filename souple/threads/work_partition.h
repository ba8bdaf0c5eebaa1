#pragma once

#include <algorithm>
#include <cstddef>

namespace souple {

/// Division of [0, n) among at most `count` threads: parts as equal as possible, none smaller than `grain`
/// unless there is only one. If the grain is 16 or more, parts begin at multiples of 16, so that only the
/// last part has a partial SIMD pack. Depends only on n, `grain` and `count`: every implementation of Threads
/// uses equal parts.
class WorkPartition {
 public:
  WorkPartition(std::size_t n, std::size_t grain, int count)
      : n_(n), unit_(grain >= pack ? pack : 1), units_(n / unit_) {
    const std::size_t min_units =
        std::max<std::size_t>(1, grain / unit_ + (grain % unit_ != 0));  // units per part
    parts_ = std::clamp<std::size_t>(units_ / min_units, 1, static_cast<std::size_t>(std::max(count, 1)));
  }

  std::size_t parts() const { return parts_; }
  /// Begin of part t; begin(parts()) = n.
  std::size_t begin(std::size_t t) const { return t < parts_ ? units_ * t / parts_ * unit_ : n_; }

 private:
  static constexpr std::size_t pack = 16;

  std::size_t n_, unit_, units_, parts_;
};

}  // namespace souple
