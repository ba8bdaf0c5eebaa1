#pragma once

#include "souple/fluid/cell_order.h"
#include "souple/fluid/kernels/density_kernels.h"
#include "souple/fluid/kernels/neighbor_kernels.h"

#include <cstdint>
#include <span>
#include <vector>

namespace souple {

/// Who is within a radius of whom: for each index of a CellOrder the places of the others, in the order of
/// rows of cells and then ascending; nobody is a neighbor of itself. Lists lie one behind the other, in
/// blocks of places that threads make by themselves. The same lists for any number of threads and with all
/// instruction sets.
class Neighbors {
 public:
  /// Lists are padded to whole sixteens, so that loops over registers need no end of their own.
  static constexpr std::uint32_t padding = 16;

  /// Consecutive places and their lists. An entry is a index times four: where its record of four floats
  /// begins. What pads a list is the index size(), of a record that is far away from all.
  struct Block {
    std::uint32_t begin = 0, end = 0;    ///< places
    std::vector<std::uint32_t> entry{};  ///< lists, one behind the other; room for a register beyond
    std::vector<std::uint32_t> first{};  ///< of index begin + k: entry[first[k]] up to entry[first[k + 1]]
    std::vector<std::uint32_t> count{};  ///< of these, how many are neighbors

    std::span<const std::uint32_t> of(std::uint32_t index) const {
      const std::uint32_t k = index - begin;
      return {entry.data() + first[k], count[k]};
    }
    std::span<const std::uint32_t> padded(std::uint32_t index) const {
      const std::uint32_t k = index - begin;
      return {entry.data() + first[k], first[k + 1] - first[k]};
    }
    /// Padded, of the places [from, to) of this block.
    kernels::NeighborLists lists(std::uint32_t from, std::uint32_t to) const {
      return {entry.data(), first.data() + (from - begin), from, to};
    }
  };

  /// Replaces what was there. Those closer than `radius`, at most the cell size the order was built with [m].
  /// Allocates nothing when warm.
  void find(const CellOrder& order, float radius, Threads& threads);

  /// By ascending places; together they have all.
  std::span<const Block> blocks() const { return {blocks_.data(), block_count_}; }
  /// All lists together.
  std::size_t count() const;
  std::size_t bytes() const;

 private:
  void make_blocks(const CellOrder& order);
  void find_in(const CellOrder& order, std::size_t block, float radius) const;

  const kernels::NeighborKernels* kernels_ = nullptr;
  std::vector<std::uint32_t> first_cell_;  // of each block
  mutable std::vector<Block> blocks_;
  std::size_t block_count_ = 0;
};

}  // namespace souple
