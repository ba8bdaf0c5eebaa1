#pragma once

#include "souple/solver/facets.h"
#include "souple/threads/threads.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace souple {

/// One coarser level of particles above a finer one.
struct CoarseLevel {
  std::vector<std::uint32_t> finer;  ///< per coarse particle: its index in the finer level, ascending
  std::vector<Link> links;           ///< between coarse particles; a < b, sorted
  /// Per link: path along finer links from a to b: path[k], k in [path_begin[e], path_begin[e + 1]).
  std::vector<std::uint32_t> path_begin, path;
  /// Per particle i of the finer level: its correction is sum_k weight[k] * correction(parent[k]), k in
  /// [parent_begin[i], parent_begin[i + 1]). The weights of a particle are non-negative and sum to 1.
  std::vector<std::uint32_t> parent_begin, parent;
  std::vector<float> weight;
  /// Per coarse particle j: mean of the finer particles that follow it, weighted by mass, sum_k
  /// child_weight[k] * child[k], k in [child_begin[j], child_begin[j + 1]). The weights sum to 1; a fixed
  /// coarse particle has itself as its only child.
  std::vector<std::uint32_t> child_begin, child;
  std::vector<float> child_weight;
  std::vector<float> mass;  ///< sum_i weight_iJ m_i over the free particles [kg]; 0: fixed
  /// Per finer link: the coarse link that gets its energy, or links.size() + j: all links of coarse particle j.
  std::vector<std::uint32_t> energy_to;
};

/// Classes of particles: levels choose fixed and heavy particles first, so that no mean of others is drawn to a heavy
/// one.
inline constexpr char free_particle = 0, fixed_particle = 1, heavy_particle = 2;
/// Mass 0: fixed. Heavy: far heavier than the lightest neighbor, as what carries a load.
std::vector<char> classes_of(std::span<const Link> links, std::span<const float> masses);

/// A level above particles [0, classes.size()), without masses and energies. It depends on the shape of the links and
/// on the classes, and takes O(n log n) time. It has as many particles as the finer one if none can be removed.
CoarseLevel build_level(std::span<const Link> links, std::span<const char> classes, Threads& threads);
/// Gives the particles of a level the masses of its finer particles.
void take_masses(std::span<const float> finer, CoarseLevel& level);
/// Gives the links of a level the energies and the stiffness of its finer links.
void take_energies(std::span<const Link> finer, CoarseLevel& level);

/// Levels above particles [0, masses.size()), finest first, until a level has at most `coarsest_size`
/// particles or none can be removed. Mass 0: a fixed particle. Depends on the arguments only.
std::vector<CoarseLevel> build_levels(std::span<const Link> links, std::span<const float> masses,
                                      std::size_t coarsest_size, Threads& threads);

}  // namespace souple
