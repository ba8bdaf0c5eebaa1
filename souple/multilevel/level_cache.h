#pragma once

#include "souple/multilevel/hierarchical_levels.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace souple {

/// Builds levels block by block. A block is a range of particles that no link leaves, such as those of one object. The
/// shape of its levels depends on nothing else. It is kept while equal links and equal fixed particles come again. So
/// an object that is added, removed or pinned builds its own levels alone. Equal blocks share them.
class LevelCache {
 public:
  /// Result of build_levels, bit for bit. `links`: sorted, a < b; every particle has one.
  std::vector<CoarseLevel> build(std::span<const Link> links, std::span<const float> masses,
                                 std::size_t coarsest_size, Threads& threads);

 private:
  /// The levels of a block, numbered from its first particle and link. They are built as deep as they are needed.
  struct Block {
    std::uint64_t hash = 0;
    std::vector<Link> links;
    std::vector<char> fixed;
    std::vector<CoarseLevel> levels;
    std::vector<char> fixed_on_last_level;

    std::size_t particles_above(std::size_t level) const {
      return level == 0 ? fixed.size() : levels[level - 1].finer.size();
    }
    void add_level(Threads& threads);
  };

  void find_blocks(std::span<const Link> links, std::span<const float> masses);
  void deepen(std::size_t levels, Threads& threads);
  CoarseLevel join(std::size_t level) const;

  std::vector<std::shared_ptr<Block>> blocks_;  // in order of their particles; equal blocks are one
};

}  // namespace souple
