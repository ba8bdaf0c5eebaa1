#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace souple {

/// Constraints sorted so that those of one color share no particle.
struct Coloring {
  std::vector<std::uint32_t> order;        ///< order[k] = which constraint comes k-th
  std::vector<std::uint32_t> color_begin;  ///< color c is order[color_begin[c] .. color_begin[c + 1])
};

/// Colors constraints in about linear time. `indices` holds the particles of constraint i at
/// [i * arity, (i + 1) * arity).
///
/// Few colors: never fewer than the most constraints that meet in a particle, seldom many more. None of them
/// tiny: at least 512 constraints, or half of the mean where there are fewer. Exception: a hub that more than
/// 64 constraints meet in makes colors of one constraint, and those are left so.
/// Within a color, constraints come by their lowest particle, so that neighbors in memory meet.
Coloring color_constraints(std::span<const std::uint32_t> indices, int arity, std::size_t particle_count);

/// The coloring that color_of[i] says, in that order within colors; colors of no constraint are left out.
Coloring sorted_by_color(std::span<const std::uint32_t> indices, int arity, std::size_t particle_count,
                         std::span<const std::uint32_t> color_of);

}  // namespace souple
