#include "app/band_velocities.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>

namespace souple::app {

namespace {

constexpr int side = NarrowBand::side;

/// Sums of weights and weighted velocities at the points of a band.
class Sums {
 public:
  Sums(const NarrowBand& band, float radius)
      : band_(band), radius_(radius), velocities_(band.bricks.size()), weights_(band.bricks.size()) {
    for (std::size_t i = 0; i < band.bricks.size(); ++i) brick_at_[band.bricks[i].first] = i;
  }

  void add(const Vec3f& position, const Vec3f& velocity) {
    const std::array<float, 3> x{position.x, position.y, position.z};
    std::array<std::int32_t, 3> first{}, last{};  // bricks that the particle may reach
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto brick_of = [&](float at) {
        return static_cast<std::int32_t>(std::floor(at / (band_.cell * float(side)))) * side;
      };
      first[axis] = brick_of(x[axis] - radius_);
      last[axis] = brick_of(x[axis] + radius_);
    }
    std::array<std::int32_t, 3> at{};
    for (at[0] = first[0]; at[0] <= last[0]; at[0] += side)
      for (at[1] = first[1]; at[1] <= last[1]; at[1] += side)
        for (at[2] = first[2]; at[2] <= last[2]; at[2] += side) {
          const auto found = brick_at_.find(at);
          if (found != brick_at_.end()) add_to_brick(found->second, x, velocity);
        }
  }

  std::vector<BrickVelocities> take() && {
    for (std::size_t i = 0; i < velocities_.size(); ++i)
      for (std::size_t point = 0; point < NarrowBand::brick_points; ++point)
        if (weights_[i][point] > 0) velocities_[i][point] = velocities_[i][point] / weights_[i][point];
    return std::move(velocities_);
  }

 private:
  void add_to_brick(std::size_t index, const std::array<float, 3>& x, const Vec3f& velocity) {
    const NarrowBand::Brick& brick = band_.bricks[index];
    std::array<int, 3> lo{}, hi{};  // points of the brick that the particle may reach
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const float first = static_cast<float>(brick.first[axis]);
      lo[axis] = std::clamp(static_cast<int>(std::ceil((x[axis] - radius_) / band_.cell - first)), 0, side);
      hi[axis] =
          std::clamp(static_cast<int>(std::floor((x[axis] + radius_) / band_.cell - first)), -1, side - 1);
    }
    for (int i = lo[0]; i <= hi[0]; ++i)
      for (int j = lo[1]; j <= hi[1]; ++j)
        for (int k = lo[2]; k <= hi[2]; ++k) {
          const auto point = static_cast<std::size_t>((i * side + j) * side + k);
          if (!brick.in_band(point)) continue;
          const Vec3f there{static_cast<float>(brick.first[0] + i), static_cast<float>(brick.first[1] + j),
                            static_cast<float>(brick.first[2] + k)};
          const float share =
              1 - length_squared(there * band_.cell - Vec3f{x[0], x[1], x[2]}) / (radius_ * radius_);
          if (share <= 0) continue;
          velocities_[index][point] += velocity * (share * share);
          weights_[index][point] += share * share;
        }
  }

  const NarrowBand& band_;
  float radius_;
  std::map<std::array<std::int32_t, 3>, std::size_t> brick_at_;
  std::vector<BrickVelocities> velocities_;
  std::vector<std::array<float, NarrowBand::brick_points>> weights_;
};

}  // namespace

std::vector<BrickVelocities> band_velocities(const NarrowBand& band, std::span<const Vec3f> positions,
                                             std::span<const Vec3f> velocities, float radius) {
  Sums sums(band, radius);
  const auto largest = static_cast<float>(1 << 23) * band.cell;  // beyond it the band has no points
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const Vec3f& x = positions[i];
    const bool near = std::abs(x.x) < largest && std::abs(x.y) < largest && std::abs(x.z) < largest;
    if (near && is_finite(velocities[i])) sums.add(x, velocities[i]);
  }
  return std::move(sums).take();
}

}  // namespace souple::app
