#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

namespace souple {

/// Sets of the numbers below a count. The root of a set is its lowest number: it does not depend on the order of joins.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t count = 0) { reset(count); }
  /// Each number becomes a set of its own.
  void reset(std::size_t count) {
    parent_.resize(count);
    std::iota(parent_.begin(), parent_.end(), 0u);
  }
  std::uint32_t root(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];  // path halving
    return i;
  }
  /// False if the two were in one set already.
  bool join(std::uint32_t i, std::uint32_t j) {
    i = root(i), j = root(j);
    parent_[std::max(i, j)] = std::min(i, j);
    return i != j;
  }
  std::size_t bytes() const { return parent_.capacity() * sizeof(parent_[0]); }

 private:
  std::vector<std::uint32_t> parent_;
};

}  // namespace souple
