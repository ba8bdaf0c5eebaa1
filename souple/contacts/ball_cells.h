#pragma once

#include "souple/contacts/kernels/vertex_balls.h"
#include "souple/math/vec3.h"
#include "souple/state/columns.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace souple {

/// Balls as they are searched.
struct SearchedBalls {
  std::span<const Vec3f> place, rest;     ///< now and at rest [m]; no rest: all that are near count
  std::span<const float> radius, margin;  ///< m
};

/// Balls of one set in the cells of a uniform grid, by counting sort, as columns: kernels compare a ball with a register of
/// others. Each pair is met once, from the ball whose cell comes first. A slot is the position of a ball in the order of
/// cells.
class BallCells {
 public:
  /// Balls near one, as the kernels search them; balls of one cell share most of it.
  struct Search {
    std::uint32_t bucket_end = 0;  // slots before share the runs
    std::array<kernels::BallRun, 10> runs;
    std::size_t run_count = 0, size = 0;
    std::vector<std::uint32_t> near;
  };

  /// Sorts the balls. `cell_size`: at least twice the largest sum of radius and margin [m]. A ball that is not finite is near
  /// none.
  void sort(const SearchedBalls& balls, float cell_size);
  /// Takes what kernels need of the slots [begin, end); before any find_near.
  void gather(const SearchedBalls& balls, std::size_t begin, std::size_t end);
  /// The number of balls in cells.
  std::size_t size() const { return ball_.size(); }
  std::uint32_t ball(std::size_t slot) const { return ball_[slot]; }
  /// Finds the slots of balls near that of `slot` (VertexBallKernels::find_in_runs). The result lives until the next call
  /// with the same search.
  std::span<const std::uint32_t> find_near(std::size_t slot, float rest_part,
                                           const kernels::VertexBallKernels& kernels, Search& search) const;
  std::size_t bytes() const;

 private:
  struct Cell {
    std::int32_t x, y, z;
    bool operator==(const Cell&) const = default;
  };
  std::uint32_t bucket_of(const Cell& cell) const;
  void find_runs(std::size_t slot, Search& search) const;

  std::vector<Cell> cells_;                        // per ball
  std::vector<std::uint32_t> bucket_begin_;        // first slot of each bucket
  std::vector<std::uint32_t> ball_;                // per slot
  ColumnStore<kernels::BallCellColumns> columns_;  // per slot
  bool compares_rest_ = false;
};

}  // namespace souple
