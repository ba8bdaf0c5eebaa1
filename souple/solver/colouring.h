#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace souple {

/// Constraints sorted so that those of one colour share no particle.
struct Colouring {
  std::vector<std::uint32_t> order;         ///< order[k] = which constraint comes k-th
  std::vector<std::uint32_t> colour_begin;  ///< colour c is order[colour_begin[c] .. colour_begin[c + 1])
};

/// Greedy colouring in the given order: each constraint takes the first colour that none of its particles has
/// yet. `indices` holds the particles of constraint i at [i * arity, (i + 1) * arity). Stable within a
/// colour. Works in rounds of 64 colours (one bit each), so a particle may be in any number of constraints.
Colouring colour_constraints(std::span<const std::uint32_t> indices, int arity, std::size_t particle_count);

}  // namespace souple
