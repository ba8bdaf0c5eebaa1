#pragma once

#include "souple/broad_phase/bounds.h"
#include "souple/broad_phase/kernels/patch_kernels.h"
#include "souple/math/vec3.h"
#include "souple/threads/threads.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace souple {

/// Resizes a vector. If it must grow, it reserves a quarter more (`spare` of its size). Sizes that vary a little from
/// step to step then soon allocate nothing.
template <class Item>
void resize_with_spare(std::vector<Item>& items, std::size_t size, double spare = 0.25) {
  if (size > items.capacity())
    items.reserve(size + static_cast<std::size_t>(static_cast<double>(size) * spare) + 16);
  items.resize(size);
}

/// Boxes by the grid cells that they overlap, in a hash table. Source: Teschner et al. 2003, "Optimized spatial hashing
/// for collision detection of deformable objects", section 3.
///
///   hash(i, j, k) = (i p1 xor j p2 xor k p3) mod n,  p1 = 73856093, p2 = 19349663, p3 = 83492791
///
/// Deviations:
/// - There are several grids; the cell size of each is four times that of the next finer one. A box is in the finest
///   grid whose cells are as large as itself, so in at most 8 cells. So a huge triangle among small ones costs no more
///   than they do. Two boxes are compared in the grid of the larger one.
/// - The hash is that of a block of 4 x 4 x 4 cells; cells are in order within it. So neighbors in space are
///   neighbors in memory, and no two cells that a box overlaps share a bucket.
/// - Buckets are filled by counting sort, first by parts of the table, then within each part. There are no
///   lists and no time stamps, and the contents are the same for any number of threads.
/// - A pair that shares several cells is reported in the cell that contains the lower corner of its
///   intersection.
class SpatialHash {
 public:
  /// Greatest number of boxes: an entry uses 3 of its 32 bits for the number of a box's cell.
  static constexpr std::size_t max_boxes = std::size_t{1} << 28;

  /// Cell size [m]: 1.5 times the median of the boxes' largest sides, over a sample of about a thousand
  /// evenly spaced boxes. 1 where the median is 0. Boxes that are not finite do not count.
  static float choose_cell_size(std::span<const Bounds> boxes);

  /// Replaces all boxes. `boxes` must outlive all queries. `cell_size`: of one of the grids [m]. Boxes that
  /// are not finite are left out. Throws Error when there are more than max_boxes. Allocates nothing when
  /// warm.
  void build(std::span<const Bounds> boxes, float cell_size, Threads& threads);

  /// Boxes [first, last) that a search leaves out. They cost it next to nothing. Examples are the surface of a long
  /// thin triangle, whose boxes nearly all overlap, and the particles of one fluid.
  struct Skip {
    std::uint32_t first = 0, last = 0;
  };

  /// Appends the indices of all boxes that overlap `box`, which may have any size, to `found`, ascending.
  void find(const Bounds& box, std::vector<std::uint32_t>& found) const { find(box, {}, found); }
  void find(const Bounds& box, Skip skip, std::vector<std::uint32_t>& found) const;
  /// Appends the indices of the boxes that overlap box a, ascending. Only boxes in a coarser grid, or in the same grid
  /// with a higher index, count. Called for every a, it finds each pair once.
  void find_partners(std::uint32_t a, std::vector<std::uint32_t>& found) const {
    find_partners(a, {}, found);
  }
  void find_partners(std::uint32_t a, Skip skip, std::vector<std::uint32_t>& found) const;

  std::size_t size() const { return boxes_.size(); }
  /// Number of entries: one per box and cell.
  std::size_t entries() const { return entry_count_; }
  std::size_t bytes() const;

 private:
  /// A grid of cells of one size, with its part of the table.
  struct Grid {
    float cell_size = 0, inverse = 0;  // m, 1/m
    std::uint32_t first_bucket = 0;
    int shift = 32;  // of the hash; the remaining bits are the block's index
    std::uint32_t boxes = 0;
  };
  /// The coarsest grid has one cell.
  static constexpr int grid_count = 16, finer_grids = 6;
  static constexpr std::uint8_t nowhere = grid_count;
  /// The cells that a box overlaps in a grid: lo, and its upper neighbors along the axes whose bits are set.
  struct Cells {
    std::int32_t lo[3];
    std::uint32_t spans;
  };
  struct Keyed {
    std::uint32_t bucket, entry;
  };

  static Cells cells_of(const Bounds& box, const Grid& grid);
  static bool fits(const Bounds& box, const Grid& grid);
  std::uint8_t grid_of(const Bounds& box) const;
  static std::uint32_t bucket_of(const Grid& grid, std::int32_t i, std::int32_t j, std::int32_t k);
  static std::uint32_t bucket_of(const Grid& grid, const Cells& cells, std::uint32_t which);
  void lay_out_grids(float cell_size);
  void assign_grids(Threads& threads);
  void lay_out_table();
  void assign_grids_of(std::size_t chunk);
  void sort_by_parts(Threads& threads);
  std::size_t sum_offsets();
  void sort_part(std::size_t part);
  template <class Function>
  void for_each_entry(std::size_t chunk, const Function& function) const;
  void find_from(const Bounds& box, int first_grid, Skip skip, std::vector<std::uint32_t>& found) const;
  void find_in(const Bounds& box, const Grid& grid, std::uint32_t first, Skip skip,
               std::vector<std::uint32_t>& found) const;
  void find_in_finer(const Bounds& box, int index, Skip skip, std::vector<std::uint32_t>& found) const;
  std::array<std::array<std::size_t, 2>, 2> entries_of(std::uint32_t bucket, Skip skip) const;

  std::span<const Bounds> boxes_;
  const kernels::PatchKernels* kernels_ = nullptr;
  std::array<Grid, grid_count> grids_;
  std::size_t entry_count_ = 0, chunks_ = 0, parts_ = 0;
  int part_shift_ = 0;
  std::vector<std::uint8_t> grid_;                                   // per box
  std::vector<std::array<std::uint32_t, grid_count + 1>> boxes_in_;  // per chunk and grid
  std::vector<std::uint32_t> offset_;                                // [part][chunk] in keyed_
  std::vector<Keyed> keyed_;                                         // by part, then box
  std::vector<std::uint32_t> end_;             // entries of bucket b: end_[b] to end_[b + 1]
  std::array<std::vector<float>, 3> lo_, hi_;  // per entry: corners of its box
  std::vector<std::uint32_t> entries_;         // 8 box + number of the box's cell
};

}  // namespace souple
