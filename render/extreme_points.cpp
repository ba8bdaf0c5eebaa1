#include "render/extreme_points.h"

#include <algorithm>
#include <cstdlib>
#include <limits>

namespace souple::render {

namespace {

/// Unit vectors through the grid points on the surface of a cube of 5 x 5 x 5.
std::array<Vec3f, ExtremePoints::directions> make_directions() {
  std::array<Vec3f, ExtremePoints::directions> result;
  std::size_t count = 0;
  for (int x = -2; x <= 2; ++x) {
    for (int y = -2; y <= 2; ++y) {
      for (int z = -2; z <= 2; ++z) {
        if (std::max({std::abs(x), std::abs(y), std::abs(z)}) == 2)
          result[count++] = normalized(Vec3f{float(x), float(y), float(z)});
      }
    }
  }
  return result;
}

const std::array<Vec3f, ExtremePoints::directions>& all_directions() {
  static const std::array<Vec3f, ExtremePoints::directions> result = make_directions();
  return result;
}

}  // namespace

ExtremePoints::ExtremePoints() {
  reach_.fill(std::numeric_limits<float>::lowest());
}

void ExtremePoints::add(const Vec3f& point, float radius) {
  const std::array<Vec3f, directions>& along = all_directions();
  for (std::size_t i = 0; i < directions; ++i) {
    const float reach = dot(point, along[i]) + radius;
    if (!(reach > reach_[i])) continue;
    reach_[i] = reach;
    points_[i] = point + along[i] * radius;
    empty_ = false;
  }
}

void ExtremePoints::add(const ExtremePoints& other) {
  for (std::size_t i = 0; i < directions; ++i) {
    if (!(other.reach_[i] > reach_[i])) continue;
    reach_[i] = other.reach_[i];
    points_[i] = other.points_[i];
    empty_ = false;
  }
}

std::span<const Vec3f> ExtremePoints::points() const {
  return empty_ ? std::span<const Vec3f>() : std::span<const Vec3f>(points_);
}

Bounds ExtremePoints::bounds() const {
  Bounds result;
  for (const Vec3f& point : points()) result.add(point);
  return result;
}

}  // namespace souple::render
