#pragma once

#include "souple/state/particles.h"
#include "tests/collision/random.h"

#include <limits>
#include <vector>

namespace souple::test {

/// Points in a cube [0, side).
inline std::vector<Vec4f> random_cloud(std::size_t count, double side, std::uint64_t seed) {
  Random random(seed);
  std::vector<Vec4f> points(count);
  for (Vec4f& point : points) point.set_xyz(Vec3f(random.point(0, side)));
  return points;
}

/// Positions that a fluid may reach: a lake, a drop a kilometer away, many points at one position, and
/// non-finite ones.
inline std::vector<Vec4f> ragged_cloud() {
  std::vector<Vec4f> points = random_cloud(1500, 0.7, 3);
  for (const Vec4f& far : random_cloud(40, 0.2, 4))
    points.push_back({far.x - 1000, far.y + 3, far.z + 1e6f, 0});
  for (int i = 0; i < 30; ++i) points.push_back({0.3f, 0.3f, 0.3f, 0});
  points.push_back({std::numeric_limits<float>::quiet_NaN(), 0, 0, 0});
  points.push_back({0, std::numeric_limits<float>::infinity(), 0, 0});
  return points;
}

}  // namespace souple::test
