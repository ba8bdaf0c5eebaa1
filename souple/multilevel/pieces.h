#pragma once

#include "souple/math/disjoint_sets.h"
#include "souple/multilevel/hierarchical_levels.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace souple {

/// The pieces that links connect particles to.
class LinkedPieces {
 public:
  LinkedPieces(std::span<const Link> links, std::size_t particles);
  /// The lowest particle of the piece of particle i.
  std::uint32_t root(std::uint32_t i) { return sets_.root(i); }
  /// Number of particles in the piece of particle i.
  std::size_t size(std::uint32_t i) { return size_[root(i)]; }

 private:
  DisjointSets sets_;
  std::vector<std::uint32_t> size_;  // per root
};

/// Per particle: whether it is at most `radius` links away from an isolated pinned particle. Isolated ones are few and
/// do not form an edge of their piece. Mass 0: pinned.
std::vector<bool> near_isolated_pins(std::span<const Link> links, std::span<const float> masses, int radius);

}  // namespace souple
