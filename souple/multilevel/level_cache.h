#pragma once

#include "souple/multilevel/hierarchical_levels.h"
#include "souple/solver/projector.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace souple {

/// The levels of some blocks, one block after the other.
struct JoinedLevels {
  std::vector<IndexRange> particles, links;  ///< of each block
  std::vector<CoarseLevel> levels;           ///< finest first; particles and links numbered within the blocks
};

/// Builds levels block by block. A block is a range of particles that no link leaves, such as those of one object. Its
/// levels depend on nothing else. Their shape is kept while equal links and equal fixed particles come again. So an
/// object that is added, removed or pinned builds its own levels alone. Equal blocks share them.
class LevelCache {
 public:
  /// Result of build_levels for each block, bit for bit. Blocks with equally many levels are joined; those without levels
  /// are left out. `links`: sorted, a < b; every particle has one.
  std::vector<JoinedLevels> build(std::span<const Link> links, std::span<const float> masses,
                                  std::size_t coarsest_size, Threads& threads);

 private:
  /// The levels of a block, numbered from its first particle and link.
  struct Block {
    std::uint64_t hash = 0;
    std::vector<Link> links;
    std::vector<char> fixed;
    std::vector<CoarseLevel> levels;
    bool built = false;

    std::size_t particles_above(std::size_t level) const {
      return level == 0 ? fixed.size() : levels[level - 1].finer.size();
    }
    /// Adds levels until one has at most `coarsest_size` particles or none can be removed.
    void build_levels(std::size_t coarsest_size, Threads& threads);
  };
  struct Place {
    std::shared_ptr<Block> block;  ///< equal blocks are one
    IndexRange particles, links;
  };

  void find_blocks(std::span<const Link> links, std::span<const float> masses);
  void build_blocks(std::size_t coarsest_size, Threads& threads);
  static CoarseLevel join(std::span<const Place* const> blocks, std::size_t level);
  static JoinedLevels join(std::span<const Place* const> blocks, std::span<const Link> links,
                           std::span<const float> masses);

  std::vector<Place> blocks_;  // in order of their particles
};

}  // namespace souple
