#include "souple/contacts/ball_cells.h"

#include "souple/broad_phase/spatial_hash.h"
#include "souple/state/bytes.h"

#include <algorithm>
#include <cmath>

namespace souple {
namespace {

constexpr std::size_t widest_register = 16;  // floats
constexpr std::int32_t nowhere = 0x7fffffff;
constexpr std::uint32_t row_side = 2048;  // rows are told apart modulo this: their numbers are exact floats

std::int32_t cell_index(float x, float cell_size) {
  return static_cast<std::int32_t>(std::floor(x / cell_size));
}

float row_number(std::int32_t y, std::int32_t z) {
  return static_cast<float>((static_cast<std::uint32_t>(y) % row_side) * row_side +
                            static_cast<std::uint32_t>(z) % row_side);
}

}  // namespace

// Cells that are neighbors along x have neighboring buckets, so that a row of them is contiguous.
std::uint32_t BallCells::bucket_of(const Cell& cell) const {
  const std::uint32_t row =
      static_cast<std::uint32_t>(cell.y) * 2654435761u ^ static_cast<std::uint32_t>(cell.z) * 2246822519u;
  return (row + static_cast<std::uint32_t>(cell.x)) & static_cast<std::uint32_t>(bucket_begin_.size() - 2);
}

// bucket_begin_ holds the counts, then the ends, then the begins of buckets. Balls keep their order within a bucket.
void BallCells::sort(const SearchedBalls& balls, float cell_size) {
  constexpr float farthest = 1e9f;  // cells
  const std::size_t n = balls.place.size();
  std::size_t buckets = 64;
  while (buckets < 2 * n) buckets *= 2;
  bucket_begin_.assign(buckets + 1, 0);
  cells_.resize(n);
  std::size_t inside = 0;
  for (std::size_t m = 0; m < n; ++m) {
    const Vec3f& x = balls.place[m];
    if (!(max(abs(x.x), max(abs(x.y), abs(x.z))) < farthest * cell_size) || !is_finite(x)) {
      cells_[m].x = nowhere;
      continue;
    }
    cells_[m] = {cell_index(x.x, cell_size), cell_index(x.y, cell_size), cell_index(x.z, cell_size)};
    ++bucket_begin_[bucket_of(cells_[m])];
    ++inside;
  }
  std::uint32_t end = 0;
  for (std::uint32_t& count : bucket_begin_) count = end += count;
  ball_.resize(inside);
  for (std::size_t m = n; m-- > 0;)
    if (cells_[m].x != nowhere) ball_[--bucket_begin_[bucket_of(cells_[m])]] = static_cast<std::uint32_t>(m);
  columns_.resize(n + widest_register);
  compares_rest_ = !balls.rest.empty();
}

void BallCells::gather(const SearchedBalls& balls, std::size_t begin, std::size_t end) {
  const kernels::BallCellColumns columns = columns_.columns();
  for (std::size_t slot = begin; slot < std::min(end, size()); ++slot) {
    const std::uint32_t m = ball_[slot];
    for (int axis = 0; axis < 3; ++axis) {
      columns.place[axis][slot] = balls.place[m][axis];
      if (compares_rest_) columns.rest[axis][slot] = balls.rest[m][axis];
    }
    columns.radius[slot] = balls.radius[m];
    columns.reach[slot] = balls.radius[m] + balls.margin[m];
    columns.row[slot] = row_number(cells_[m].y, cells_[m].z);
  }
}

// 13 of the 26 cells around one follow it: the next one in its row, whose bucket follows its own, and four whole rows.
void BallCells::find_runs(std::size_t slot, Search& search) const {
  constexpr std::int32_t rows[4][2] = {{0, 1}, {1, -1}, {1, 0}, {1, 1}};
  const Cell cell = cells_[ball_[slot]];
  const std::size_t buckets = bucket_begin_.size() - 1;
  search.run_count = search.size = 0;
  // Buckets [first, first + n), which may continue at the begin of the table. The first run is always there.
  const auto add = [&](std::size_t first, std::size_t n, float row) {
    const std::size_t end = std::min(first + n, buckets);
    const auto add_run = [&](std::size_t b, std::size_t e) {
      search.size += bucket_begin_[e] - bucket_begin_[b];
      if (bucket_begin_[b] < bucket_begin_[e])
        search.runs[search.run_count++] = {bucket_begin_[b], bucket_begin_[e], row};
    };
    add_run(first, end);
    if (end - first < n) add_run(0, n - (end - first));
  };
  const std::uint32_t own = bucket_of(cell);
  search.bucket_end = bucket_begin_[own + 1];
  add(own, 2, row_number(cell.y, cell.z));
  for (const auto& [y, z] : rows)
    add(bucket_of({cell.x - 1, cell.y + y, cell.z + z}), 3, row_number(cell.y + y, cell.z + z));
}

// In the ball's own cell, later slots.
std::span<const std::uint32_t> BallCells::find_near(std::size_t slot, float rest_part,
                                                    const kernels::VertexBallKernels& kernels,
                                                    Search& search) const {
  const bool same = slot > 0 && slot < search.bucket_end && cells_[ball_[slot]] == cells_[ball_[slot - 1]];
  if (!same) find_runs(slot, search);
  search.runs[0].begin = slot + 1;
  if (search.near.size() < search.size) resize_with_spare(search.near, search.size, 1);
  kernels::BallCellColumns columns = columns_.columns();
  if (!compares_rest_) columns.rest[0] = nullptr;
  return {search.near.data(), kernels.find_in_runs(columns, slot, rest_part, search.runs.data(),
                                                   search.run_count, search.near.data())};
}

std::size_t BallCells::bytes() const {
  return bytes_of(cells_, bucket_begin_, ball_) + columns_.bytes();
}

}  // namespace souple
