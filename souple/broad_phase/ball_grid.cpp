#include "souple/broad_phase/ball_grid.h"

#include "souple/math/limits.h"
#include "souple/state/bytes.h"

#include <cmath>

namespace souple {
namespace {

std::int32_t cell_index(float x, float cell_size) {
  return cell_of(double(x) / double(cell_size));
}

}  // namespace

// Counting sort. bucket_begin_ holds the counts, then the ends, then the begins of buckets. Members keep
// their order within a bucket.
void BallGrid::sort_into_cells(float cell_size) {
  std::size_t buckets = 64;
  while (buckets < 2 * position_.size()) buckets *= 2;
  bucket_begin_.assign(buckets + 1, 0);
  const auto bucket_of = [&](const Cell& cell) {
    return (bucket_of_row(cell.y, cell.z) + static_cast<std::uint32_t>(cell.x)) & (buckets - 1);
  };
  cells_.clear();
  for (const Vec3f& at : position_) {
    const Cell cell = is_finite(at) ? Cell{cell_index(at.x, cell_size), cell_index(at.y, cell_size),
                                           cell_index(at.z, cell_size)}
                                    : Cell{nowhere, nowhere, nowhere};
    cells_.push_back(cell);
    ++bucket_begin_[bucket_of(cell)];
  }
  std::uint32_t end = 0;
  for (std::uint32_t& count : bucket_begin_) count = end += count;
  entries_.resize(position_.size());
  for (std::size_t m = position_.size(); m-- > 0;)
    entries_[--bucket_begin_[bucket_of(cells_[m])]] = {position_[m], radius_[m],
                                                       static_cast<std::uint32_t>(m), cells_[m]};
}

std::size_t BallGrid::bytes() const {
  return bytes_of(position_, radius_, cells_, bucket_begin_, entries_);
}

}  // namespace souple
