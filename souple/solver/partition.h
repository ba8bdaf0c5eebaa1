#pragma once

#include "souple/solver/coloring.h"

#include <cstdint>
#include <span>
#include <vector>

namespace souple {

/// Constraints in a chosen number of colors, made possible by phantoms: a particle in which more constraints
/// meet than there are colors is split, and each phantom takes a share of them. Constraints of one color
/// share no phantom and no particle that is whole.
struct Partition {
  Coloring coloring;
  /// What the constraints act on, in the order of `coloring`: the k-th has [k * arity, (k + 1) * arity).
  /// Whole particles keep their number; a split one is replaced by one of its phantoms.
  std::vector<std::uint32_t> indices;
  /// Phantom first_phantom + j stands for particle phantom_of[j]; ascending. A split particle has at least
  /// two, and their shares of its constraints differ by one at most.
  std::vector<std::uint32_t> phantom_of;
};

/// Fratarcangeli & Pellacini 2015, "Scalable Partitioning for Parallel Position Based Dynamics": makes the
/// constraint graph colorable with `colors` >= 1 colors by adding phantoms greedily.
/// The constraints are colored already and sorted by color: `color_begin` as in Coloring, their particles
/// in `indices` as color_constraints takes them, each below particle_count <= first_phantom. Where they have
/// no more than `colors`, nothing is split and the order stays.
Partition partition_constraints(std::span<const std::uint32_t> indices, int arity, std::size_t particle_count,
                                std::span<const std::uint32_t> color_begin, int colors,
                                std::uint32_t first_phantom);

}  // namespace souple
