#include "souple/broad_phase/spatial_hash.h"

#include "souple/assert.h"
#include "souple/broad_phase/kernels/find_kernels.h"
#include "souple/error.h"
#include "souple/state/bytes.h"

#include <algorithm>
#include <bit>
#include <limits>

#include <fmt/core.h>

namespace souple {
namespace {

constexpr std::size_t chunk_size = 4096;     // boxes
constexpr std::size_t buckets_per_box = 2;   // least number in a grid
constexpr std::uint32_t block_buckets = 64;  // 4 x 4 x 4 cells
constexpr int min_part_shift = 12;           // the counts of a part of the table fit in the L1 cache
constexpr std::size_t max_parts = 256;       // of the table
constexpr float cell_per_side = 1.5f;        // in largest sides of the median box
constexpr float max_cells = 8388608;         // from the origin: 2^23, up to which floats distinguish cells

float largest_side(const Bounds& box) {
  const Vec3f side = box.hi - box.lo;
  return max(side.x, max(side.y, side.z));
}

// For |x| below max_cells. std::floor is a function call where the processor may lack the instruction.
std::int32_t floor_of(float x) {
  const auto i = static_cast<std::int32_t>(x);
  return i - (x < static_cast<float>(i) ? 1 : 0);
}

}  // namespace

float SpatialHash::choose_cell_size(std::span<const Bounds> boxes) {
  constexpr std::size_t max_samples = 1024;
  std::array<float, max_samples> sides;  // NOLINT(cppcoreguidelines-pro-type-member-init)
  std::size_t samples = 0;
  const std::size_t stride = boxes.size() / max_samples + 1;
  for (std::size_t b = 0; b < boxes.size(); b += stride)
    if (is_finite(boxes[b])) sides[samples++] = largest_side(boxes[b]);
  if (samples == 0) return 1;
  const auto median = sides.begin() + static_cast<std::ptrdiff_t>(samples / 2);
  std::nth_element(sides.begin(), median, sides.begin() + static_cast<std::ptrdiff_t>(samples));
  return *median > 0 ? cell_per_side * *median : 1;
}

// For a box that overlaps at most two cells along each axis.
SpatialHash::Cells SpatialHash::cells_of(const Bounds& box, const Grid& grid) {
  Cells cells{};
  for (int axis = 0; axis < 3; ++axis) {
    cells.lo[axis] = floor_of(box.lo[axis] * grid.inverse);
    const bool more = floor_of(box.hi[axis] * grid.inverse) > cells.lo[axis];
    cells.spans |= static_cast<std::uint32_t>(more) << axis;
  }
  return cells;
}

// Whether the box overlaps at most two cells along each axis, and floats distinguish its cells.
bool SpatialHash::fits(const Bounds& box, const Grid& grid) {
  for (int axis = 0; axis < 3; ++axis) {
    const float lo = box.lo[axis] * grid.inverse, hi = box.hi[axis] * grid.inverse;
    if (!(lo > -max_cells && hi < max_cells) || floor_of(hi) - floor_of(lo) > 1) return false;
  }
  return true;
}

// The finest grid whose cells are as large as the box. In coarser grids it also overlaps at most two cells
// along each axis: cell sizes differ by powers of two, so nothing rounds.
std::uint8_t SpatialHash::grid_of(const Bounds& box) const {
  if (!is_finite(box)) return nowhere;
  const float side = largest_side(box);
  std::uint8_t g = 0;
  while (side > grids_[g].cell_size || !fits(box, grids_[g])) ++g;
  return g;
}

std::uint32_t SpatialHash::bucket_of(const Grid& grid, std::int32_t i, std::int32_t j, std::int32_t k) {
  const std::uint32_t hash = static_cast<std::uint32_t>(i >> 2) * 73856093u ^
                             static_cast<std::uint32_t>(j >> 2) * 19349663u ^
                             static_cast<std::uint32_t>(k >> 2) * 83492791u;
  // The upper bits of the product with 2^32 / golden ratio depend on all bits of the hash (Knuth, section
  // 6.4).
  const std::uint32_t block = hash * 2654435769u >> grid.shift;
  return grid.first_bucket + block * block_buckets +
         static_cast<std::uint32_t>((i & 3) | (j & 3) << 2 | (k & 3) << 4);
}

std::uint32_t SpatialHash::bucket_of(const Grid& grid, const Cells& cells, std::uint32_t which) {
  const auto step = [which](int axis) { return static_cast<std::int32_t>(which >> axis & 1); };
  return bucket_of(grid, cells.lo[0] + step(0), cells.lo[1] + step(1), cells.lo[2] + step(2));
}

void SpatialHash::build(std::span<const Bounds> boxes, float cell_size, Threads& threads) {
  if (boxes.size() > max_boxes)
    throw Error(fmt::format("SpatialHash: {} boxes; at most {} fit", boxes.size(), max_boxes));
  boxes_ = boxes;
  kernels_ = &kernels::find_patch_kernels(instruction_set());
  chunks_ = (boxes.size() + chunk_size - 1) / chunk_size;
  lay_out_grids(cell_size);
  assign_grids(threads);
  lay_out_table();
  sort_by_parts(threads);
  threads.each(parts_, 1, [this](std::size_t part) { sort_part(part); });
}

void SpatialHash::lay_out_grids(float cell_size) {
  float size = std::clamp(cell_size, 1e-20f, 1e20f);
  for (int finer = 0; finer < finer_grids; ++finer) size /= 4;
  for (Grid& grid : grids_) {
    grid = {size, 1 / size, 0, 32, 0};
    size *= 4;
  }
  for (Grid& grid : grids_) grid.inverse = grids_[0].inverse * (grids_[0].cell_size / grid.cell_size);
  grids_.back().cell_size = std::numeric_limits<float>::infinity();
  grids_.back().inverse = 0;
}

// Finds the grid of each box and counts the boxes of each grid.
void SpatialHash::assign_grids(Threads& threads) {
  grid_.resize(boxes_.size());
  boxes_in_.resize(chunks_);
  threads.each(chunks_, 1, [this](std::size_t chunk) { assign_grids_of(chunk); });
  for (const auto& counts : boxes_in_)
    for (std::size_t g = 0; g < grid_count; ++g) grids_[g].boxes += counts[g];
}

void SpatialHash::assign_grids_of(std::size_t chunk) {
  auto& counts = boxes_in_[chunk];
  counts.fill(0);
  const std::size_t end = std::min(boxes_.size(), (chunk + 1) * chunk_size);
  for (std::size_t b = chunk * chunk_size; b < end; ++b) ++counts[grid_[b] = grid_of(boxes_[b])];
}

// Each grid has its own range of buckets, so that a bucket contains boxes of one grid only.
void SpatialHash::lay_out_table() {
  std::uint32_t buckets = 0;
  for (Grid& grid : grids_) {
    grid.first_bucket = buckets;
    if (grid.boxes == 0) continue;
    const std::size_t blocks = std::bit_ceil(grid.boxes * buckets_per_box / block_buckets + 2);
    grid.shift = 32 - std::countr_zero(blocks);
    buckets += static_cast<std::uint32_t>(blocks) * block_buckets;
  }
  part_shift_ = min_part_shift;
  while ((std::size_t{buckets} >> part_shift_) >= max_parts) ++part_shift_;
  parts_ = buckets == 0 ? 0 : ((buckets - 1) >> part_shift_) + 1;
  resize_with_spare(end_, std::size_t{buckets} + 1);
  end_[0] = 0;
}

// Calls function(bucket, entry) for each cell of each box of a chunk, in order of boxes.
template <class Function>
void SpatialHash::for_each_entry(std::size_t chunk, const Function& function) const {
  const std::size_t end = std::min(boxes_.size(), (chunk + 1) * chunk_size);
  for (std::size_t b = chunk * chunk_size; b < end; ++b) {
    if (grid_[b] == nowhere) continue;
    const Grid& grid = grids_[grid_[b]];
    SOUPLE_ASSERT(fits(boxes_[b], grid), "a box spans at most two cells along each axis");
    const Cells cells = cells_of(boxes_[b], grid);
    for (std::uint32_t which = 0; which < 8; ++which)
      if ((which & ~cells.spans) == 0)
        function(bucket_of(grid, cells, which), static_cast<std::uint32_t>(b) << 3 | which);
  }
}

// Counting sort by parts of the table. Each chunk counts its entries per part. The prefix sums over (part,
// chunk) then give each chunk its offsets, so entries are in order of part, chunk, box.
void SpatialHash::sort_by_parts(Threads& threads) {
  resize_with_spare(offset_, parts_ * chunks_);
  threads.each(chunks_, 1, [this](std::size_t chunk) {
    std::array<std::uint32_t, max_parts> counts{};
    for_each_entry(chunk, [&](std::uint32_t bucket, std::uint32_t) { ++counts[bucket >> part_shift_]; });
    for (std::size_t part = 0; part < parts_; ++part) offset_[part * chunks_ + chunk] = counts[part];
  });
  entry_count_ = sum_offsets();
  resize_with_spare(keyed_, entry_count_);
  resize_with_spare(entries_, entry_count_ + kernels::BoxGroup::max_items);
  for (auto* columns : {&lo_, &hi_})
    for (auto& column : *columns) resize_with_spare(column, entry_count_ + kernels::BoxGroup::max_items);
  threads.each(chunks_, 1, [this](std::size_t chunk) {
    std::array<std::uint32_t, max_parts> next{};
    for (std::size_t part = 0; part < parts_; ++part) next[part] = offset_[part * chunks_ + chunk];
    for_each_entry(chunk, [&](std::uint32_t bucket, std::uint32_t entry) {
      keyed_[next[bucket >> part_shift_]++] = {bucket, entry};
    });
  });
}

std::size_t SpatialHash::sum_offsets() {
  std::uint32_t sum = 0;
  for (std::uint32_t& offset : offset_) {
    const std::uint32_t count = offset;
    offset = sum;
    sum += count;
  }
  return sum;
}

// Counting sort of a part by buckets. end_[b + 1] is first the count of bucket b, then the slot of its next
// entry, and its end after the last entry.
void SpatialHash::sort_part(std::size_t part) {
  const std::size_t first = part << part_shift_;
  const std::size_t last = std::min(end_.size() - 1, (part + 1) << part_shift_);
  const std::size_t begin = offset_[part * chunks_];
  const std::size_t end = part + 1 < parts_ ? offset_[(part + 1) * chunks_] : entry_count_;
  std::fill(end_.begin() + static_cast<std::ptrdiff_t>(first) + 1,
            end_.begin() + static_cast<std::ptrdiff_t>(last) + 1, 0u);
  for (std::size_t e = begin; e < end; ++e) ++end_[keyed_[e].bucket + 1];
  auto next = static_cast<std::uint32_t>(begin);
  for (std::size_t bucket = first; bucket < last; ++bucket) {
    const std::uint32_t count = end_[bucket + 1];
    end_[bucket + 1] = next;
    next += count;
  }
  SOUPLE_ASSERT(next == end, "buckets hold all entries of the part");
  for (std::size_t e = begin; e < end; ++e) {
    SOUPLE_ASSERT(first <= keyed_[e].bucket && keyed_[e].bucket < last, "a bucket of the part");
    const std::uint32_t slot = end_[keyed_[e].bucket + 1]++;
    entries_[slot] = keyed_[e].entry;
    const Bounds& box = boxes_[keyed_[e].entry >> 3];
    for (int axis = 0; axis < 3; ++axis) {
      lo_[static_cast<std::size_t>(axis)][slot] = box.lo[axis];
      hi_[static_cast<std::size_t>(axis)][slot] = box.hi[axis];
    }
  }
}

// The entries of a bucket, begin and end, before and after those that are left out. They are in order of boxes.
std::array<std::array<std::size_t, 2>, 2> SpatialHash::entries_of(std::uint32_t bucket, Skip skip) const {
  const std::size_t begin = end_[bucket], end = end_[bucket + 1];
  if (skip.first >= skip.last || begin == end) return {{{begin, end}, {end, end}}};
  const auto first_from = [&](std::size_t from, std::uint32_t box) {
    const auto at = std::lower_bound(entries_.begin() + static_cast<std::ptrdiff_t>(from),
                                     entries_.begin() + static_cast<std::ptrdiff_t>(end), box << 3);
    return static_cast<std::size_t>(at - entries_.begin());
  };
  const std::size_t left = first_from(begin, skip.first);
  return {{{begin, left}, {first_from(left, skip.last), end}}};
}

// Finds overlapping boxes of one grid with index `first` or higher. The grid's cells must not be smaller than
// `box`.
void SpatialHash::find_in(const Bounds& box, const Grid& grid, std::uint32_t first, Skip skip,
                          std::vector<std::uint32_t>& found) const {
  const kernels::BoxColumns columns{
      {lo_[0].data(), lo_[1].data(), lo_[2].data()}, {hi_[0].data(), hi_[1].data(), hi_[2].data()}, {}};
  const float corners[] = {box.lo.x, box.lo.y, box.lo.z, box.hi.x, box.hi.y, box.hi.z};
  const Cells cells = cells_of(box, grid);
  for (std::uint32_t which = 0; which < 8; ++which) {
    if ((which & ~cells.spans) != 0) continue;
    for (const auto& [begin, last] : entries_of(bucket_of(grid, cells, which), skip)) {
      if (begin == last) continue;
      std::size_t count = found.size();
      found.resize(count + last - begin);
      // A pair counts in the cell where its intersection begins: not where both boxes come from the previous
      // cell along an axis.
      const std::size_t hits = kernels_->overlapping(columns, begin, last - begin, corners, entries_.data(),
                                                     which, found.data() + count);
      const std::size_t end = count + hits;
      for (std::size_t hit = count; hit < end; ++hit) {
        const std::uint32_t b = found[hit] >> 3;
        found[count] = b;
        count += b >= first ? 1 : 0;
      }
      found.resize(count);
    }
  }
}

void SpatialHash::find_from(const Bounds& box, int first_grid, Skip skip,
                            std::vector<std::uint32_t>& found) const {
  for (int g = first_grid; g < grid_count; ++g)
    if (grids_[static_cast<std::size_t>(g)].boxes > 0)
      find_in(box, grids_[static_cast<std::size_t>(g)], 0, skip, found);
}

void SpatialHash::find_partners(std::uint32_t a, Skip skip, std::vector<std::uint32_t>& found) const {
  const auto before = static_cast<std::ptrdiff_t>(found.size());
  const int grid = grid_[a];
  if (grid == nowhere) return;
  find_in(boxes_[a], grids_[static_cast<std::size_t>(grid)], a + 1, skip, found);
  find_from(boxes_[a], grid + 1, skip, found);
  std::sort(found.begin() + before, found.end());
}

void SpatialHash::find(const Bounds& box, Skip skip, std::vector<std::uint32_t>& found) const {
  const auto before = static_cast<std::ptrdiff_t>(found.size());
  const int grid = grid_of(box);
  if (grid == nowhere) return;
  for (int g = 0; g < grid; ++g)
    if (grids_[static_cast<std::size_t>(g)].boxes > 0) find_in_finer(box, g, skip, found);
  find_from(box, grid, skip, found);
  std::sort(found.begin() + before, found.end());
}

// A large box in a grid of smaller cells: cell by cell, or box by box where boxes are fewer than cells.
void SpatialHash::find_in_finer(const Bounds& box, int index, Skip skip,
                                std::vector<std::uint32_t>& found) const {
  const Grid& grid = grids_[static_cast<std::size_t>(index)];
  std::int32_t lo[3], hi[3];
  double cells = 1;
  for (int axis = 0; axis < 3; ++axis) {
    lo[axis] = floor_of(std::clamp(box.lo[axis] * grid.inverse, -max_cells, max_cells));
    hi[axis] = floor_of(std::clamp(box.hi[axis] * grid.inverse, -max_cells, max_cells));
    cells *= double(hi[axis]) - double(lo[axis]) + 1;
  }
  const std::size_t skipped = skip.last > skip.first ? skip.last - skip.first : 0;
  if (cells > double(boxes_.size() - std::min(skipped, boxes_.size()))) {
    const auto among = [&](std::size_t begin, std::size_t end) {
      for (std::size_t b = begin; b < end; ++b)
        if (grid_[b] == index && overlap(box, boxes_[b])) found.push_back(static_cast<std::uint32_t>(b));
    };
    among(0, std::min<std::size_t>(skip.first, boxes_.size()));
    among(std::max(skip.first, skip.last), boxes_.size());
    return;
  }
  for (std::int32_t k = lo[2]; k <= hi[2]; ++k)
    for (std::int32_t j = lo[1]; j <= hi[1]; ++j)
      for (std::int32_t i = lo[0]; i <= hi[0]; ++i) {
        for (const auto& [begin, end] : entries_of(bucket_of(grid, i, j, k), skip))
          for (std::size_t e = begin; e < end; ++e) {
            const std::uint32_t b = entries_[e] >> 3;
            const Cells other = cells_of(boxes_[b], grid);
            const bool first_here = std::max(lo[0], other.lo[0]) == i && std::max(lo[1], other.lo[1]) == j &&
                                    std::max(lo[2], other.lo[2]) == k;
            if (first_here && overlap(box, boxes_[b])) found.push_back(b);
          }
      }
}

std::size_t SpatialHash::bytes() const {
  return bytes_of(grid_, boxes_in_, offset_, keyed_, end_, entries_, lo_[0], lo_[1], lo_[2], hi_[0], hi_[1],
                  hi_[2]);
}

}  // namespace souple
