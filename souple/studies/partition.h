#pragma once

#include "souple/solver/coloring.h"
#include "souple/solver/projector.h"

#include <cstdint>
#include <span>
#include <vector>

namespace souple {

/// Constraints in a chosen number of colors. A particle with several constraints of one color is split into
/// phantoms, and each phantom gets a part of its constraints. Constraints of one color share no phantom and
/// no unsplit particle.
struct Partition {
  Coloring coloring;
  /// Particles or phantoms of the constraints, in the order of `coloring`: constraint k has [k * arity, (k +
  /// 1) * arity). Unsplit particles keep their number; a split particle is replaced by one of its phantoms.
  std::vector<std::uint32_t> indices;
  /// Phantom first_phantom + j stands for particle phantom_of[j]; ascending. A split particle has at least
  /// two phantoms, whose numbers of constraints differ by at most one.
  std::vector<std::uint32_t> phantom_of;
};

/// Fratarcangeli & Pellacini 2015, "Scalable Partitioning for Parallel Position Based Dynamics": makes the
/// constraint graph colorable with `colors` >= 1 colors by adding phantoms greedily. The input is colored and
/// sorted by color: `color_begin` as in Coloring, the particles in `indices` as for color_constraints, each
/// below particle_count <= first_phantom. If it has at most `colors` colors, nothing is split and the order
/// stays.
Partition partition_constraints(std::span<const std::uint32_t> indices, int arity, std::size_t particle_count,
                                std::span<const std::uint32_t> color_begin, int colors,
                                std::uint32_t first_phantom);

/// Partitions the constraints of a projector, whose `project` then acts on phantoms from `first_phantom` on. Returns the
/// particle of each phantom; empty if no particle was split or the kind cannot be split. Facets::study restores it.
std::vector<std::uint32_t> split(Projector& projector, int colors, std::uint32_t first_phantom);

}  // namespace souple
