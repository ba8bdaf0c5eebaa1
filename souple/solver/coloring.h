#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace souple {

/// Constraints sorted by color; constraints of one color share no particle.
struct Coloring {
  std::vector<std::uint32_t> order;        ///< order[k]: index of the k-th constraint
  std::vector<std::uint32_t> color_begin;  ///< color c is order[color_begin[c] .. color_begin[c + 1])
};

/// Colors constraints in about linear time. `indices` holds the particles of constraint i at [i * arity, (i +
/// 1) * arity).
///
/// The number of colors is at least the largest number of constraints that meet in a particle, and seldom
/// much more. No color is tiny: each has at least 512 constraints, or half the mean size if that is less.
/// Exception: a hub particle with more than 64 constraints causes colors of one constraint, which stay as
/// they are. Within a color, constraints are sorted by their lowest particle, so that neighbors use
/// neighboring memory.
Coloring color_constraints(std::span<const std::uint32_t> indices, int arity, std::size_t particle_count);

/// Coloring in which constraint i has color color_of[i]. Within a color, constraints are sorted by their
/// lowest particle. Empty colors are removed.
Coloring sorted_by_color(std::span<const std::uint32_t> indices, int arity, std::size_t particle_count,
                         std::span<const std::uint32_t> color_of);

/// Whether constraints of one color share no particle. `indices`: of constraints in the order of their colors.
bool are_independent(std::span<const std::uint32_t> indices, int arity,
                     std::span<const std::uint32_t> color_begin);

}  // namespace souple
