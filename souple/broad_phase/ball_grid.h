#pragma once

#include "souple/math/vec3.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace souple {

/// A uniform grid of balls, filled by counting sort: finds the balls near another one.
class BallGrid {
 public:
  /// Replaces the balls. position(m) - corner() is where ball m is; a ball that is not finite is in no cell.
  /// `cell_size`: at least the search radius plus the largest radius [m].
  template <class Relative, class Radius>
  void fill(std::size_t count, const Vec3f& corner, float cell_size, const Relative& relative,
            const Radius& radius) {
    corner_ = corner;
    position_.clear(), radius_.clear();
    for (std::size_t m = 0; m < count; ++m) position_.push_back(relative(m)), radius_.push_back(radius(m));
    sort_into_cells(cell_size);
  }
  void clear() { position_.clear(); }
  const Vec3f& corner() const { return corner_; }
  /// Position of a ball when the grid was filled, relative to the corner [m].
  const Vec3f& position(std::size_t ball) const { return position_[ball]; }

  /// Calls f(other) for the later balls whose distance from `ball` is less than margin plus both radii, in the order
  /// of cells.
  template <class Function>
  void for_each_near(std::uint32_t ball, float margin, const Function& f) const {
    const Cell cell = cells_[ball];
    if (cell.x == nowhere) return;
    const Vec3f at = position_[ball];
    const float r = radius_[ball] + margin;
    const std::size_t mask = bucket_begin_.size() - 2;
    const auto scan = [&](std::size_t begin, std::size_t end, std::int32_t y, std::int32_t z) {
      for (std::size_t e = bucket_begin_[begin]; e < bucket_begin_[end]; ++e) {
        const Entry& other = entries_[e];
        const float search_radius = r + other.radius;
        // One branch, not four: the outcome of each is random to a branch predictor.
        const bool near = (other.ball > ball) & (other.cell.y == y) & (other.cell.z == z) &
                          (length_squared(at - other.at) < search_radius * search_radius);
        if (near) f(other.ball);
      }
    };
    for (std::int32_t z = cell.z - 1; z <= cell.z + 1; ++z) {
      for (std::int32_t y = cell.y - 1; y <= cell.y + 1; ++y) {
        const std::size_t begin = (bucket_of_row(y, z) + static_cast<std::uint32_t>(cell.x) - 1u) & mask;
        const std::size_t end = min(begin + 3, mask + 1);
        scan(begin, end, y, z);
        if (end - begin < 3) scan(0, 3 - (end - begin), y, z);  // the row continues at the table's begin
      }
    }
  }
  std::size_t bytes() const;

 private:
  struct Cell {
    std::int32_t x, y, z;
  };
  /// A ball in the grid: a copy, so that neighbors are contiguous in memory.
  struct Entry {
    Vec3f at;
    float radius;
    std::uint32_t ball;
    Cell cell;
  };
  static constexpr std::int32_t nowhere = 0x7fffffff;
  // Cells that are neighbors along x have neighboring buckets, so that three of them are contiguous in memory.
  static std::uint32_t bucket_of_row(std::int32_t y, std::int32_t z) {
    return static_cast<std::uint32_t>(y) * 2654435761u ^ static_cast<std::uint32_t>(z) * 2246822519u;
  }
  void sort_into_cells(float cell_size);

  Vec3f corner_{};
  std::vector<Vec3f> position_;
  std::vector<float> radius_;
  std::vector<Cell> cells_;
  std::vector<std::uint32_t> bucket_begin_;
  std::vector<Entry> entries_;  // sorted by bucket, then ball
};

}  // namespace souple
