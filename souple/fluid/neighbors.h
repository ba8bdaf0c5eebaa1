#pragma once

#include "souple/fluid/cell_order.h"
#include "souple/fluid/kernels/density_kernels.h"
#include "souple/fluid/kernels/neighbor_kernels.h"

#include <cstdint>
#include <span>
#include <vector>

namespace souple {

/// Neighbor lists: for each sorted index of a CellOrder, the sorted indices of all other particles within a
/// radius. A list is ordered by rows of cells, then ascending. Lists are contiguous within blocks, which
/// threads fill independently. They do not depend on the number of threads or the instruction set.
class Neighbors {
 public:
  /// Lists are padded to multiples of sixteen, so that loops over registers need no remainder.
  static constexpr std::uint32_t padding = 16;

  /// Consecutive particles and their lists. An entry is four times a sorted index: the offset of the
  /// neighbor's record of four floats. Padding entries refer to index size(), a record far away from all
  /// particles.
  struct Block {
    std::uint32_t begin = 0, end = 0;    ///< range of sorted indices
    std::vector<std::uint32_t> entry{};  ///< lists, contiguous; spare capacity of one register at the end
    std::vector<std::uint32_t>
        first{};  ///< list of index begin + k: entry[first[k]] up to entry[first[k + 1]]
    std::vector<std::uint32_t> count{};  ///< number of neighbors in each list, without padding

    std::span<const std::uint32_t> of(std::uint32_t index) const {
      const std::uint32_t k = index - begin;
      return {entry.data() + first[k], count[k]};
    }
    std::span<const std::uint32_t> padded(std::uint32_t index) const {
      const std::uint32_t k = index - begin;
      return {entry.data() + first[k], first[k + 1] - first[k]};
    }
    /// Padded lists of the sorted indices [from, to) of this block.
    kernels::NeighborLists lists(std::uint32_t from, std::uint32_t to) const {
      return {entry.data(), first.data() + (from - begin), from, to};
    }
  };

  /// Replaces all lists by those of `radius` [m], at most the cell size of the order. Allocates nothing once
  /// capacities suffice.
  void find(const CellOrder& order, float radius, Threads& threads);

  /// Blocks by ascending sorted index; together they cover all particles.
  std::span<const Block> blocks() const { return {blocks_.data(), block_count_}; }
  /// Number of neighbors in all lists.
  std::size_t count() const;
  std::size_t bytes() const;

 private:
  void make_blocks(const CellOrder& order);
  void find_in(const CellOrder& order, std::size_t block, float radius) const;

  const kernels::NeighborKernels* kernels_ = nullptr;
  std::vector<std::uint32_t> first_cell_;  // per block
  mutable std::vector<Block> blocks_;
  std::size_t block_count_ = 0;
};

}  // namespace souple
