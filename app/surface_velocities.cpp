#include "app/surface_velocities.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace souple::app {

namespace {

using Cell = std::array<std::int32_t, 3>;

/// Particles in order of their cells, whose width is the radius: of a row of cells they lie in succession.
class ParticleGrid {
 public:
  ParticleGrid(std::span<const Vec3f> positions, std::span<const Vec3f> velocities, float radius)
      : radius_(radius) {
    for (std::size_t i = 0; i < positions.size(); ++i)
      if (is_in_range(positions[i]) && is_finite(velocities[i]))
        particles_.push_back({cell_of(positions[i]), positions[i], velocities[i]});
    std::stable_sort(particles_.begin(), particles_.end(),
                     [](const Particle& a, const Particle& b) { return a.cell < b.cell; });
  }

  struct Particle {
    Cell cell;
    Vec3f position, velocity;
  };
  /// The particles of the 27 cells around one.
  using Rows = std::array<std::span<const Particle>, 9>;

  Rows rows_around(const Cell& middle) const {
    Rows rows;
    for (std::int32_t i = 0; i < 9; ++i) {
      const Cell first{middle[0] + i / 3 - 1, middle[1] + i % 3 - 1, middle[2] - 1};
      const Cell last{first[0], first[1], first[2] + 2};
      rows[static_cast<std::size_t>(i)] = {std::ranges::lower_bound(particles_, first, {}, &Particle::cell),
                                           std::ranges::upper_bound(particles_, last, {}, &Particle::cell)};
    }
    return rows;
  }

  Vec3f mean_around(const Vec3f& x, const Rows& rows) const {
    Vec3f sum{};
    float weights = 0;
    for (const auto& row : rows) {
      for (const Particle& p : row) {
        const float square = length_squared(p.position - x);
        if (square >= radius_ * radius_) continue;
        const float share = 1 - square / (radius_ * radius_);
        sum += p.velocity * (share * share);
        weights += share * share;
      }
    }
    return weights > 0 ? sum / weights : sum;
  }

  bool is_in_range(const Vec3f& x) const {
    const float largest = static_cast<float>(1 << 23) * radius_;
    return std::abs(x.x) < largest && std::abs(x.y) < largest && std::abs(x.z) < largest;
  }
  Cell cell_of(const Vec3f& x) const {
    const auto along = [&](float at) { return static_cast<std::int32_t>(std::floor(at / radius_)); };
    return {along(x.x), along(x.y), along(x.z)};
  }

 private:
  float radius_;
  std::vector<Particle> particles_;
};

}  // namespace

std::vector<Vec3f> surface_velocities(std::span<const Vec3f> points, std::span<const Vec3f> positions,
                                      std::span<const Vec3f> velocities, float radius, Threads& threads) {
  const ParticleGrid grid(positions, velocities, radius);
  std::vector<Vec3f> result(points.size());
  constexpr std::size_t grain = 1024;
  threads.for_each(points.size(), grain, [&](std::size_t begin, std::size_t end) {
    Cell cell{};
    ParticleGrid::Rows rows = grid.rows_around(cell);  // often those of the next point too
    for (std::size_t i = begin; i < end; ++i) {
      if (!grid.is_in_range(points[i])) continue;
      const Cell next = grid.cell_of(points[i]);
      if (next != cell) rows = grid.rows_around(cell = next);
      result[i] = grid.mean_around(points[i], rows);
    }
  });
  return result;
}

std::vector<Vec3f> band_points(const NarrowBand& band) {
  std::vector<Vec3f> points;
  for (const NarrowBand::Brick& brick : band.bricks)
    for (std::size_t i = 0; i < NarrowBand::brick_points; ++i) {
      if (!brick.in_band(i)) continue;
      const auto at = [&](std::size_t axis, std::size_t step) {
        return static_cast<float>(brick.first[axis] + static_cast<std::int32_t>(step)) * band.cell;
      };
      points.push_back({at(0, i / 64), at(1, i / 8 % 8), at(2, i % 8)});
    }
  return points;
}

}  // namespace souple::app
