#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace souple {

/// A distance that a material keeps, as the levels of a hierarchy see it.
struct Link {
  std::uint32_t a = 0, b = 0;
  float length = 0;     ///< at rest, along the material [m]
  float energy = 0;     ///< k l^2, twice the energy at strain 1 [J]; infinite where rigid
  float stiffness = 1;  ///< PBD mode: k in [0, 1]

  bool operator==(const Link&) const = default;
};

/// One coarser level of particles above a finer one.
struct CoarseLevel {
  std::vector<std::uint32_t> finer;  ///< of each coarse particle, which of the finer level it is; ascending
  std::vector<Link> links;           ///< between coarse particles; a < b, sorted
  /// A way along finer links from a to b of each link: way[k], k in [path_begin[e], path_begin[e + 1]).
  std::vector<std::uint32_t> path_begin, path;
  /// Where the correction of the finer level's particle i comes from:
  /// sum_k weight[k] * correction(parent[k]), k in [parent_begin[i], parent_begin[i + 1]). Weights of a
  /// particle are at least 0 and sum to 1.
  std::vector<std::uint32_t> parent_begin, parent;
  std::vector<float> weight;
  /// Mean of the finer particles that follow coarse particle j, by mass: sum_k share[k] * of child[k], k in
  /// [child_begin[j], child_begin[j + 1]). Shares sum to 1; one that does not move has itself alone.
  std::vector<std::uint32_t> child_begin, child;
  std::vector<float> child_weight;
  std::vector<float> mass;  ///< sum_i weight_i,J m_i of the particles that move [kg]; 0: does not move
};

/// Levels above particles [0, masses.size()), finest first, until one has no more than `smallest` particles
/// or no particle more can be spared. Mass 0 marks a particle that does not move. Depends on nothing but what
/// is given; takes O(n log n) time.
std::vector<CoarseLevel> build_levels(std::span<const Link> links, std::span<const float> masses,
                                      std::size_t coarsest_size);

}  // namespace souple
