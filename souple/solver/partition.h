#pragma once

#include "souple/solver/colouring.h"

#include <cstdint>
#include <span>
#include <vector>

namespace souple {

/// Constraints in a chosen number of colours, made possible by phantoms: a particle in which more constraints
/// meet than there are colours is split, and each phantom takes a share of them. Constraints of one colour
/// share no phantom and no particle that is whole.
struct Partition {
  Colouring colouring;
  /// What the constraints act on, in the order of `colouring`: the k-th has [k * arity, (k + 1) * arity).
  /// Whole particles keep their number; a split one is replaced by one of its phantoms.
  std::vector<std::uint32_t> indices;
  /// Phantom first_phantom + j stands for particle phantom_of[j]; ascending. A split particle has at least
  /// two, and their shares of its constraints differ by one at most.
  std::vector<std::uint32_t> phantom_of;
};

/// Fratarcangeli & Pellacini 2015, "Scalable Partitioning for Parallel Position Based Dynamics": makes the
/// constraint graph colourable with `colours` >= 1 colours by adding phantoms greedily.
/// The constraints are coloured already and sorted by colour: `colour_begin` as in Colouring, their particles
/// in `indices` as colour_constraints takes them, each below particle_count <= first_phantom. Where they have
/// no more than `colours`, nothing is split and the order stays.
Partition partition_constraints(std::span<const std::uint32_t> indices, int arity, std::size_t particle_count,
                                std::span<const std::uint32_t> colour_begin, int colours,
                                std::uint32_t first_phantom);

}  // namespace souple
