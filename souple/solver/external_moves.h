#pragma once

#include "souple/solver/projector.h"

#include <algorithm>
#include <span>
#include <vector>

namespace souple {

/// Sums the motion of some particles by the sweeps of some projectors during a solve, for example contacts. So the
/// motion by the elastic constraints is known as well.
class ExternalMoves {
 public:
  /// Sweeps of all projectors but `internal` will count, for these particles, ascending. Sums start at zero.
  void begin(std::span<const Projector* const> internal, std::span<const std::uint32_t> particles) {
    internal_ = internal;
    particles_ = particles;
    sums_.assign(particles.size(), {});
  }
  bool concerns(const Projector& projector) const {
    if (projector.size() == 0) return false;
    for (const Projector* const other : internal_)
      if (other == &projector) return false;
    return true;
  }
  /// Call before and after a sweep of a projector that concerns.
  void before(const ParticleView& view) { add(view, -1); }
  void after(const ParticleView& view) { add(view, 1); }
  /// Adds a move of one particle. [m]
  void add(std::uint32_t particle, const Vec3f& move) {
    const auto found = std::lower_bound(particles_.begin(), particles_.end(), particle);
    if (found != particles_.end() && *found == particle)
      sums_[static_cast<std::size_t>(found - particles_.begin())] += move;
  }
  /// Per particle. [m]
  std::span<const Vec3f> sums() const { return sums_; }

 private:
  void add(const ParticleView& view, float sign) {
    for (std::size_t k = 0; k < particles_.size(); ++k) sums_[k] += view.moved(particles_[k]) * sign;
  }

  std::span<const Projector* const> internal_;
  std::span<const std::uint32_t> particles_;
  std::vector<Vec3f> sums_;
};

}  // namespace souple
