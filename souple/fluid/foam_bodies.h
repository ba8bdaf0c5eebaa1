#pragma once

#include "souple/collision/spatial_hash.h"
#include "souple/math/vec3.h"
#include "souple/solver/threads.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace souple {

/// Surfaces that foam does not go through: triangles that move in a straight line during a step. Found by the
/// boxes of their ways, and tested as contacts are (collision/continuous.h).
class FoamBodies {
 public:
  void clear() { triangles_.clear(); }
  /// A triangle and how close foam comes to it. [m]
  void add(const std::array<Vec3f, 3>& start, const std::array<Vec3f, 3>& end, float gap) {
    triangles_.push_back({start, end, gap});
  }
  bool none() const { return triangles_.empty(); }
  /// After the last of them.
  void build(Threads& threads);
  /// Puts each particle, on its way from its start to x, before what it would go through.
  void keep_out(std::span<const Vec3f> start, std::span<Vec3f> x, Threads& threads);
  std::size_t bytes() const;

 private:
  struct MovingTriangle {
    std::array<Vec3f, 3> start, end;
    float gap;
  };
  /// Where a particle meets a triangle, carried on to the end of the step: x has to be at least `gap` along
  /// `normal` from `point`.
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
  std::vector<std::vector<std::uint32_t>> near_;  // of each chunk of particles: scratch
};

}  // namespace souple
