#pragma once

#include "souple/math/disjoint_sets.h"
#include "souple/multilevel/hierarchical_levels.h"

#include <algorithm>
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

/// The pieces of a world's particles, and which of them levels act on in a substep.
class ActivePieces {
 public:
  static constexpr std::uint32_t none = ~std::uint32_t{0};
  /// Clears all: of so many particles of the world.
  void reset(std::size_t particles) { piece_of_.assign(particles, none), acts_.clear(); }
  std::uint32_t add() {
    acts_.push_back(1);
    return static_cast<std::uint32_t>(acts_.size() - 1);
  }
  void set(std::uint32_t particle, std::uint32_t piece) { piece_of_[particle] = piece; }
  std::size_t count() const { return acts_.size(); }
  std::size_t particles() const { return piece_of_.size(); }
  /// The piece of a particle, or none.
  std::uint32_t of(std::uint32_t particle) const { return piece_of_[particle]; }

  void start_all() { std::fill(acts_.begin(), acts_.end(), std::uint8_t{1}); }
  /// Levels no longer act on the piece of the particle, if it is in one.
  void stop(std::uint32_t particle) {
    if (of(particle) != none) acts_[of(particle)] = 0;
  }
  bool acts(std::uint32_t particle) const { return of(particle) != none && acts_[of(particle)] != 0; }
  bool any() const { return std::find(acts_.begin(), acts_.end(), 1) != acts_.end(); }
  bool all() const { return std::find(acts_.begin(), acts_.end(), 0) == acts_.end(); }

 private:
  std::vector<std::uint32_t> piece_of_;
  std::vector<std::uint8_t> acts_;  // per piece
};

/// Per particle: whether it is at most `radius` links away from an isolated pinned particle. Isolated ones are few and
/// do not form an edge of their piece. Mass 0: pinned.
std::vector<bool> near_isolated_pins(std::span<const Link> links, std::span<const float> masses, int radius);

}  // namespace souple
