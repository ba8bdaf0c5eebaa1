#pragma once

#include "souple/fluid/cell_order.h"
#include "souple/fluid/kernels/neighbour_kernels.h"

#include <cstdint>
#include <span>
#include <vector>

namespace souple {

/// Who is within a radius of whom: for each place of a CellOrder the places of the others, in the order of
/// rows of cells and then ascending; nobody is a neighbour of itself. Lists lie one behind the other, in
/// blocks of places that threads make by themselves. The same lists for any number of threads and with all
/// instruction sets.
class Neighbours {
 public:
  /// Consecutive places and their lists.
  struct Block {
    std::uint32_t begin = 0, end = 0;    ///< places
    std::vector<std::uint32_t> index{};  ///< lists, one behind the other; room for a register beyond
    std::vector<std::uint32_t> first{};  ///< of place begin + k: index[first[k]] to index[first[k + 1]]

    std::span<const std::uint32_t> of(std::uint32_t place) const {
      const std::uint32_t k = place - begin;
      return {index.data() + first[k], first[k + 1] - first[k]};
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
  void cut(const CellOrder& order);
  void find_in(const CellOrder& order, std::size_t block, float radius) const;

  const kernels::NeighbourKernels* kernels_ = nullptr;
  std::vector<std::uint32_t> first_cell_;  // of each block
  mutable std::vector<Block> blocks_;
  std::size_t block_count_ = 0;
};

}  // namespace souple
