#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace souple {

/// A constraint between two particles.
struct TreeLink {
  std::uint32_t a = 0, b = 0;             ///< particles
  std::uint32_t set = 0, constraint = 0;  ///< its set and its number there, as the caller counts them
  bool has_length = true;                 ///< false: its ends coincide at rest
};

/// A particle of a tree. Children come before their parents.
struct TreeNode {
  std::uint32_t particle = 0;
  std::uint32_t parent = 0;               ///< node; a root is its own parent
  std::uint32_t set = 0, constraint = 0;  ///< of the link to the parent
};

/// Trees of links. Tree t consists of the nodes begin[t] up to begin[t + 1]; its root is the last.
struct DistanceTrees {
  std::vector<TreeNode> nodes;
  std::vector<std::uint32_t> begin{0};
  std::size_t size() const { return begin.size() - 1; }
};

/// Finds the trees among links, in order of their lowest particle, which is the root:
/// - all links that disappear when particles with a single link are removed again and again. These are ropes, chains,
///   and loads on them, up to the tied body;
/// - among the remaining links, which are part of a cycle or connect cycles, all unbranched paths of at least three
///   links. An example is a rope between two points of a cloth. A ring of at least eight links is cut at one.
/// A single link without length is omitted: sweeps and levels treat it as a tie (TiedParticles).
DistanceTrees find_trees(std::span<const TreeLink> links, std::size_t particle_count);

}  // namespace souple
