#pragma once

#include "souple/state/particles.h"
#include "souple/threads/threads.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

namespace souple {

/// Particles sorted by the grid cell that contains them: by z, then y, then x, then input order. Consecutive
/// cells along x are contiguous in memory, so all particles within one cell size of a particle lie in nine
/// such rows. Only occupied cells are stored: a particle that flies far away costs no more than any other.
///
/// Uses a stable radix sort with at most eleven bits per pass, over the bits that the grid's extent needs.
/// The order does not depend on the number of threads.
///
/// A particle's position in this order is its sorted index.
class CellOrder {
 public:
  struct Cell {
    std::uint32_t begin;  ///< its first sorted index; it ends at the next cell's begin
    std::int32_t x;
  };
  /// Cells of equal y and z, sorted by x.
  struct Row {
    std::uint32_t begin;  ///< its first cell; it ends at the next row's begin
    std::int32_t y, z;
  };

  /// Replaces the previous order. `cell_size` > 0 [m]. Positions that are not finite go to the first cell.
  /// Allocates nothing once capacities suffice.
  void build(std::span<const Vec4f> positions, float cell_size, Threads& threads);

  std::size_t size() const { return order_.size(); }
  /// Per sorted index: the particle's index in the input.
  std::span<const std::uint32_t> order() const { return order_; }
  /// x, y or z per sorted index; readable for 16 floats beyond the last.
  const float* component(int axis) const { return component_[static_cast<std::size_t>(axis)].data(); }

  /// Lower corner of cell (0, 0, 0) along an axis [m].
  double corner(int axis) const { return corner_[axis]; }
  /// Cells, then rows; each list ends with a sentinel that marks the end of its last entry.
  std::span<const Cell> cells() const { return cells_; }
  std::span<const Row> rows() const { return rows_; }
  std::size_t cell_count() const { return cells_.size() - 1; }
  std::size_t row_count() const { return rows_.size() - 1; }
  std::size_t bytes() const;

  /// Cell coordinate of x along an axis, whether or not the cell is occupied; NaN gives a coordinate below
  /// all cells.
  std::int32_t cell(int axis, float x) const {
    const double at = std::floor((static_cast<double>(x) - corner_[axis]) * inverse_);
    return at > -1e9 ? static_cast<std::int32_t>(std::min(at, 1e9)) : -1000000000;
  }
  /// Calls f(first sorted index, end) for the cells lo <= (x, y, z) <= hi, row by row.
  template <class Function>
  void for_each_in(const std::int32_t (&lo)[3], const std::int32_t (&hi)[3], const Function& f) const {
    const auto first_row = [&](std::int32_t y, std::int32_t z) {
      return std::partition_point(rows_.begin(), rows_.end() - 1,
                                  [&](const Row& row) { return row.z < z || (row.z == z && row.y < y); });
    };
    for (auto row = first_row(lo[1], lo[2]); row < rows_.end() - 1 && row->z <= hi[2];) {
      if (row->y > hi[1]) {
        row = first_row(lo[1], row->z + 1);
        continue;
      }
      if (row->y < lo[1]) {
        row = first_row(lo[1], row->z);
        continue;
      }
      const Cell *const begin = cells_.data() + row->begin, *const end = cells_.data() + (row + 1)->begin;
      const auto first = std::partition_point(begin, end, [&](const Cell& cell) { return cell.x < lo[0]; });
      const auto last = std::partition_point(first, end, [&](const Cell& cell) { return cell.x <= hi[0]; });
      if (first != last) f(first->begin, last->begin);
      ++row;
    }
  }

 private:
  /// A key and its particle: packed into one number if the key has at most 32 bits.
  struct WideItem {
    std::uint64_t key;
    std::uint32_t particle;
  };
  using NarrowItem = std::uint64_t;

  void find_grid(std::span<const Vec4f> positions, float cell_size, Threads& threads);
  std::uint64_t key_of(const Vec4f& position) const;
  template <class Item>
  void sort(std::span<const Vec4f> positions, std::array<std::vector<Item>, 2>& items, Threads& threads);
  template <class Item>
  void sort_pass(const std::vector<Item>& from, std::vector<Item>& to, int shift, int bits, Threads& threads);
  template <class Item>
  void store_order(std::span<const Vec4f> positions, const std::vector<Item>& sorted, Threads& threads);
  template <class Item>
  void find_cells(const std::vector<Item>& sorted, Threads& threads);

  double corner_[3] = {}, inverse_ = 1;  // m, 1/m
  int bits_[3] = {};                     // bits of a cell coordinate along each axis
  std::array<std::vector<NarrowItem>, 2> narrow_;
  std::array<std::vector<WideItem>, 2> wide_;
  std::vector<std::array<float, 6>> chunk_bounds_;
  std::vector<std::uint32_t> histogram_;  // [chunk][digit]
  std::vector<std::array<std::uint32_t, 2>>
      chunk_first_;  // per chunk: the first cell and row that begin in it or later
  std::vector<std::uint32_t> order_;
  std::array<std::vector<float>, 3> component_;
  std::vector<Cell> cells_{{0, 0}};
  std::vector<Row> rows_{{0, 0, 0}};
};

}  // namespace souple
