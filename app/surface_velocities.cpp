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

  Vec3f mean_around(const Vec3f& x) const {
    Vec3f sum{};
    float weights = 0;
    if (!is_in_range(x)) return sum;
    const Cell middle = cell_of(x);
    for (std::int32_t i = -1; i <= 1; ++i) {
      for (std::int32_t j = -1; j <= 1; ++j) {
        const Cell first{middle[0] + i, middle[1] + j, middle[2] - 1};
        for (auto p = row_from(first); p != particles_.end() && is_in_row(p->cell, first); ++p) {
          const float share = 1 - length_squared(p->position - x) / (radius_ * radius_);
          if (share <= 0) continue;
          sum += p->velocity * (share * share);
          weights += share * share;
        }
      }
    }
    return weights > 0 ? sum / weights : sum;
  }

 private:
  struct Particle {
    Cell cell;
    Vec3f position, velocity;
  };
  using Iterator = std::vector<Particle>::const_iterator;

  bool is_in_range(const Vec3f& x) const {
    const float largest = static_cast<float>(1 << 23) * radius_;
    return std::abs(x.x) < largest && std::abs(x.y) < largest && std::abs(x.z) < largest;
  }
  Cell cell_of(const Vec3f& x) const {
    const auto along = [&](float at) { return static_cast<std::int32_t>(std::floor(at / radius_)); };
    return {along(x.x), along(x.y), along(x.z)};
  }
  Iterator row_from(const Cell& first) const {
    return std::lower_bound(particles_.begin(), particles_.end(), first,
                            [](const Particle& p, const Cell& cell) { return p.cell < cell; });
  }
  static bool is_in_row(const Cell& cell, const Cell& first) {
    return cell[0] == first[0] && cell[1] == first[1] && cell[2] <= first[2] + 2;
  }

  float radius_;
  std::vector<Particle> particles_;
};

}  // namespace

std::vector<Vec3f> surface_velocities(std::span<const Vec3f> vertices, std::span<const Vec3f> positions,
                                      std::span<const Vec3f> velocities, float radius, Threads& threads) {
  const ParticleGrid grid(positions, velocities, radius);
  std::vector<Vec3f> result(vertices.size());
  constexpr std::size_t grain = 1024;
  threads.for_each(vertices.size(), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) result[i] = grid.mean_around(vertices[i]);
  });
  return result;
}

}  // namespace souple::app
