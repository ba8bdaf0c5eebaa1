#pragma once

#include "souple/broad_phase/spatial_hash.h"
#include "souple/math/vec3.h"
#include "souple/threads/threads.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace souple {

/// Surfaces that foam cannot cross: triangles that move along straight lines during a step. A spatial hash of
/// the boxes of their paths finds them, and continuous tests decide (collision/continuous.h).
class FoamBodies {
 public:
  void clear() { triangles_.clear(); }
  /// Adds a triangle and the minimum distance of foam from it [m].
  void add(const std::array<Vec3f, 3>& start, const std::array<Vec3f, 3>& end, float gap) {
    triangles_.push_back({start, end, gap});
  }
  bool none() const { return triangles_.empty(); }
  /// Call after the last add.
  void build(Threads& threads);
  /// Moves each particle whose path from its start to x would cross a triangle in front of this triangle.
  void keep_out(std::span<const Vec3f> start, std::span<Vec3f> x, Threads& threads);
  std::size_t bytes() const;

 private:
  struct MovingTriangle {
    std::array<Vec3f, 3> start, end;
    float gap;
  };
  /// An impact of a particle on a triangle, extrapolated to the end of the step: x must be at least `gap`
  /// from `point` along `normal`.
  struct Impact {
    double time = 1;
    Vec3d point{}, normal{};
    double gap = 0;
  };

  static Impact find_impact(const MovingTriangle& triangle, const Vec3f& start, const Vec3f& x);
  Vec3f stopped(const Vec3f& start, const Vec3f& x, std::vector<std::uint32_t>& near) const;

  std::vector<MovingTriangle> triangles_;
  std::vector<Bounds> boxes_;
  SpatialHash hash_;
  std::vector<std::vector<std::uint32_t>> near_;  // per chunk of particles; scratch
};

}  // namespace souple
