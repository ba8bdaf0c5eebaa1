#pragma once

#include <algorithm>
#include <cstddef>

namespace souple {

/// How [0, n) is cut for at most `count` threads: into parts as equal as can be, none smaller than `grain`.
/// Where the grain is 16 or more, parts begin at multiples of 16, so that each holds whole SIMD packs and
/// only the last one a rest. It depends on nothing else: every implementation of Threads cuts alike.
class WorkPartition {
 public:
  WorkPartition(std::size_t n, std::size_t grain, int count)
      : n_(n), unit_(grain >= pack ? pack : 1), units_(n / unit_) {
    const std::size_t min_units =
        std::max<std::size_t>(1, grain / unit_ + (grain % unit_ != 0));  // units a part
    parts_ = std::clamp<std::size_t>(units_ / min_units, 1, static_cast<std::size_t>(std::max(count, 1)));
  }

  std::size_t parts() const { return parts_; }
  /// Where part t begins; begin(parts()) = n.
  std::size_t begin(std::size_t t) const { return t < parts_ ? units_ * t / parts_ * unit_ : n_; }

 private:
  static constexpr std::size_t pack = 16;

  std::size_t n_, unit_, units_, parts_;
};

}  // namespace souple
