#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace souple {

/// A constraint between two particles.
struct TreeLink {
  std::uint32_t a = 0, b = 0;  ///< particles
  std::uint32_t set = 0;       ///< number of its set, for the caller
  std::uint32_t constraint = 0;
};

/// A particle of a tree. Children come before their parents.
struct TreeNode {
  std::uint32_t particle = 0;
  std::uint32_t parent = 0;  ///< node; of a root: the root itself
  std::uint32_t link = 0;    ///< link to the parent; of a root: meaningless
};

/// Trees of links. Tree t has the nodes begin[t] up to begin[t + 1]; its root is the last of them.
struct DistanceTrees {
  std::vector<TreeNode> nodes;
  std::vector<std::uint32_t> begin{0};
};

/// The trees among links: what remains of nothing when particles of one link are removed again and again (ropes,
/// chains, and what hangs on them, up to the body that they are attached to), and between the rest, which has
/// cycles, every unbranched path of at least three links (a rope between two points of a cloth). A ring is cut at
/// one link. Trees of a single link are omitted: projection alone is exact for them.
DistanceTrees find_trees(std::span<const TreeLink> links, std::size_t particles);

}  // namespace souple
