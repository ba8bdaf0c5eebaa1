#pragma once

#include "render/camera.h"

#include <array>
#include <cstddef>
#include <span>

namespace souple::render {

/// The points of a set that lie farthest in each of 98 directions. A camera that sees them sees the set, up to 3 % of
/// its size. A bounding box can be several times larger than the set, such as that of a rope across a room.
class ExtremePoints {
 public:
  static constexpr std::size_t directions = 98;

  ExtremePoints();

  /// A point, or a ball around it. [m]
  void add(const Vec3f& point, float radius = 0);
  void add(const ExtremePoints& other);

  bool empty() const { return empty_; }
  /// Repeats points that lie farthest in several directions.
  std::span<const Vec3f> points() const;
  Bounds bounds() const;

 private:
  std::array<Vec3f, directions> points_{};
  std::array<float, directions> reach_;  ///< of each point along its direction [m]
  bool empty_ = true;
};

}  // namespace souple::render
