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

/// Colours constraints in about linear time. `indices` holds the particles of constraint i at
/// [i * arity, (i + 1) * arity).
///
/// Few colours: never fewer than the most constraints that meet in a particle, seldom many more. None of them
/// tiny: at least 512 constraints, or half of the mean where there are fewer. Exception: a hub that more than
/// 64 constraints meet in makes colours of one constraint, and those are left so.
/// Within a colour, constraints come by their lowest particle, so that neighbours in memory meet.
Colouring colour_constraints(std::span<const std::uint32_t> indices, int arity, std::size_t particle_count);

/// The colouring that colour_of[i] says, in that order within colours; colours of no constraint are left out.
Colouring sorted_by_colour(std::span<const std::uint32_t> indices, int arity, std::size_t particle_count,
                           std::span<const std::uint32_t> colour_of);

}  // namespace souple
