#include "souple/fluid/neighbors.h"

#include "souple/assert.h"
#include "souple/fluid/kernels/find_kernels.h"
#include "souple/state/bytes.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace souple {

namespace {

/// The nine rows around a row, and in each the cells from x - 1 to x + 1, for increasing x.
class Windows {
 public:
  explicit Windows(const CellOrder& order) : cells_(order.cells()), rows_(order.rows()) {}

  /// Starts a row, at any x.
  void enter(std::size_t row) {
    count_ = 0;
    const CellOrder::Row& here = rows_[row];
    for (std::int32_t dz = -1; dz <= 1; ++dz) {
      for (std::size_t at = first_of(here.y - 1, here.z + dz); at + 1 < rows_.size(); ++at) {
        if (rows_[at].z != here.z + dz || rows_[at].y > here.y + 1) break;
        windows_[count_++] = {rows_[at].begin, rows_[at].begin, rows_[at + 1].begin};
      }
    }
  }
  /// Advances to x, which must not decrease; returns the number of index ranges.
  std::size_t move_to(std::int32_t x, kernels::IndexRange* ranges) {
    std::size_t found = 0;
    for (std::size_t w = 0; w < count_; ++w) {
      Window& window = windows_[w];
      while (window.first < window.last && cells_[window.first].x < x - 1) ++window.first;
      window.end = std::max(window.end, window.first);
      while (window.end < window.last && cells_[window.end].x <= x + 1) ++window.end;
      if (window.first < window.end) ranges[found++] = {cells_[window.first].begin, cells_[window.end].begin};
    }
    return found;
  }

 private:
  struct Window {
    std::uint32_t first, end;  // cells
    std::uint32_t last;        // end of the row
  };
  std::size_t first_of(std::int32_t y, std::int32_t z) const {
    const auto end = rows_.end() - 1;
    const auto before = [](const CellOrder::Row& row, const std::pair<std::int32_t, std::int32_t>& at) {
      return row.z != at.first ? row.z < at.first : row.y < at.second;
    };
    return static_cast<std::size_t>(std::lower_bound(rows_.begin(), end, std::pair(z, y), before) -
                                    rows_.begin());
  }

  std::span<const CellOrder::Cell> cells_;
  std::span<const CellOrder::Row> rows_;
  Window windows_[9] = {};
  std::size_t count_ = 0;
};

}  // namespace

void Neighbors::find(const CellOrder& order, float radius, Threads& threads) {
  if (kernels_ == nullptr) kernels_ = &kernels::find_neighbor_kernels(instruction_set());
  make_blocks(order);
  threads.each(block_count_, 1, [&](std::size_t b) { find_in(order, b, radius); });
}

// Blocks of whole cells, with about 1024 particles each.
void Neighbors::make_blocks(const CellOrder& order) {
  constexpr std::uint32_t particles_per_block = 1024;
  first_cell_.clear();
  std::uint32_t next = 0;
  for (std::uint32_t c = 0; c < order.cell_count(); ++c) {
    if (order.cells()[c].begin < next) continue;
    first_cell_.push_back(c);
    next = order.cells()[c].begin + particles_per_block;
  }
  block_count_ = first_cell_.size();
  first_cell_.push_back(static_cast<std::uint32_t>(order.cell_count()));
  if (blocks_.size() < block_count_) blocks_.resize(block_count_);
}

void Neighbors::find_in(const CellOrder& order, std::size_t number, float radius) const {
  const auto cells = order.cells();
  const auto rows = order.rows();
  const kernels::PointColumns points{{order.component(0), order.component(1), order.component(2)}};
  const std::uint32_t first_cell = first_cell_[number], last_cell = first_cell_[number + 1];
  Block& block = blocks_[number];
  block.begin = cells[first_cell].begin;
  block.end = cells[last_cell].begin;
  block.first.resize(block.end - block.begin + std::size_t{1});
  block.count.resize(block.end - block.begin);
  std::uint32_t *first = block.first.data(), *near = block.count.data();
  const auto far = static_cast<std::uint32_t>(4 * order.size());
  std::uint32_t used = 0;
  const auto row_of = [&](std::uint32_t cell) {
    return std::upper_bound(rows.begin(), rows.end() - 1, cell,
                            [](std::uint32_t c, const CellOrder::Row& r) { return c < r.begin; }) -
           rows.begin() - 1;
  };
  Windows windows(order);
  kernels::IndexRange ranges[9];
  auto row = static_cast<std::size_t>(row_of(first_cell));
  windows.enter(row);
  for (std::uint32_t c = first_cell; c < last_cell; ++c) {
    if (c >= rows[row + 1].begin) windows.enter(++row);
    const std::size_t count = windows.move_to(cells[c].x, ranges);
    std::size_t candidates = 0;
    for (std::size_t r = 0; r < count; ++r) candidates += ranges[r].end - ranges[r].begin;
    for (std::uint32_t i = cells[c].begin; i < cells[c + 1].begin; ++i) {
      const std::size_t needed = used + candidates + std::size_t{2} * padding;
      if (block.entry.size() < needed) block.entry.resize(std::max(needed, block.entry.size() * 3 / 2));
      std::uint32_t* list = block.entry.data() + used;
      *first++ = used;
      *near = kernels_->near_point(points, i, ranges, count, radius * radius, list);
      SOUPLE_ASSERT(*near <= candidates, "at most all candidates are near");
      const std::uint32_t whole = (*near + padding - 1) / padding * padding;
      std::fill(list + *near++, list + whole, far);
      used += whole;
    }
  }
  SOUPLE_ASSERT(near == block.count.data() + block.count.size(), "one list per particle of the block");
  *first = used;
}

std::size_t Neighbors::count() const {
  std::size_t sum = 0;
  for (const Block& block : blocks()) sum = std::accumulate(block.count.begin(), block.count.end(), sum);
  return sum;
}

std::size_t Neighbors::bytes() const {
  std::size_t sum = bytes_of(first_cell_, blocks_);
  for (const Block& block : blocks_) sum += bytes_of(block.entry, block.first, block.count);
  return sum;
}

}  // namespace souple
