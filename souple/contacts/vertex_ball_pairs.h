#pragma once

#include "souple/broad_phase/contact_surface.h"
#include "souple/contacts/ball_cells.h"
#include "souple/contacts/kernels/vertex_balls.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace souple {

/// Balls at the vertices of one surface, and the pairs of them that may touch.
///
/// The radius of a ball is radius_part of the mean length of the edges at its vertex. Two balls keep the sum of their
/// radii, but never more than rest_part of their distance at rest. Two vertices of one edge never touch. So the shape at
/// rest has no contact, also where its sheets are close to each other.
///
/// Pairs are sorted by color: those of one color share no particle.
class VertexBallPairs {
 public:
  static constexpr float radius_part = 0.5f, rest_part = 0.8f;

  VertexBallPairs(const ContactSurface& surface, const ParticlePairs& joined);

  std::uint32_t begin() const { return begin_; }
  std::uint32_t end() const { return end_; }
  std::size_t count() const { return end_ - begin_; }
  float largest_radius() const { return largest_radius_; }
  float radius(std::size_t ball) const { return radius_[ball]; }

  // A search: set all balls, sort, gather and then search all blocks, end. Different balls and blocks may be treated at the
  // same time.

  void begin_search(const Vec3f& corner) { corner_ = corner; }
  /// A ball is at `place` relative to the corner, and may go as far as `path` before the next search, relative to the
  /// others [m].
  void set(std::size_t ball, const Vec3f& place, float path) {
    place_[ball] = place;
    margin_[ball] = max(min_margin, min(path_part * path / largest_radius_, max_margin)) * largest_radius_;
  }
  void sort() { cells_.sort({place_, rest_, radius_, margin_}, 2 * (1 + max_margin) * largest_radius_); }
  std::size_t block_count() const { return blocks_.size(); }
  void gather(std::size_t block) {
    cells_.gather({place_, rest_, radius_, margin_}, block * block_size, (block + 1) * block_size);
  }
  void search(std::size_t block, const kernels::VertexBallKernels& kernels);
  /// Colors the pairs that were found, and sorts them.
  void end_search();
  /// Forgets the pairs.
  void clear();

  const Vec3f& corner() const { return corner_; }
  /// Place of a ball in the last search [m].
  const Vec3f& place(std::size_t ball) const { return place_[ball]; }
  /// How far the ball may go from there without a new pair, if others go no farther than theirs [m].
  float margin(std::size_t ball) const { return margin_[ball]; }
  /// Whether a ball is in any pair.
  bool has_pair(std::size_t ball) const { return has_pair_[ball] != 0; }
  std::size_t color_count() const { return color_begin_.size() - 1; }
  /// Pairs [begin, end) of a color.
  std::array<std::size_t, 2> pairs_of(std::size_t color) const {
    return {color_begin_[color], color_begin_[color + 1]};
  }
  kernels::BallPairColumns columns() const { return columns_.columns(); }
  std::size_t bytes() const;

 private:
  static constexpr std::size_t block_size = 1024;  // slots
  // Limits of the margin of a ball, in largest radii. Smaller ones cost more searches, larger ones more pairs.
  static constexpr float min_margin = 0.1f, max_margin = 0.5f, path_part = 1.1f;
  struct Pair {
    std::uint32_t i, j;
    float distance;
    std::uint32_t color;
  };

  void find_radii(std::span<const Edge> sides);
  void find_near_at_rest(std::vector<Edge> links, const kernels::VertexBallKernels& kernels);
  void append_near_at_rest(std::vector<Pair>& pairs) const;
  void color_pairs();

  std::uint32_t begin_, end_;
  std::vector<Vec3f> rest_;    // relative to the first [m]
  std::vector<float> radius_;  // [m]
  float largest_radius_ = 0;
  std::vector<Pair> near_at_rest_;  // whose distance is that at rest
  ParticlePairs joined_;            // that never touch
  Vec3f corner_{};
  std::vector<Vec3f> place_;  // relative to the corner, in the last search [m]
  std::vector<float> margin_;
  BallCells cells_;
  struct Block {
    std::vector<Pair> pairs;  // of balls in its slots with balls in later ones
    BallCells::Search cells;
  };
  std::vector<Block> blocks_;
  std::vector<std::uint64_t> colors_;   // per ball: bits of the colors of its pairs
  std::vector<std::uint8_t> has_pair_;  // per ball
  std::vector<std::size_t> color_begin_{0}, next_slot_;
  ColumnStore<kernels::BallPairColumns> columns_;  // by color, of the world's records
};

}  // namespace souple
