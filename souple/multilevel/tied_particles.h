#pragma once

#include "souple/solver/projector.h"

#include <algorithm>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace souple {

/// Particles that rigid constraints hold at one place (distances of rest length 0, as `connect` makes them) or at a
/// target (attachments). The levels of cloth see one particle, or a fixed one. Depends on the constraints and masses
/// alone, not on positions.
class TiedParticles {
 public:
  TiedParticles() = default;
  TiedParticles(std::span<Projector* const> projectors, const ParticleView& particles);

  /// The particle that stands for all that are tied to it: a fixed one, else the lowest.
  std::uint32_t representative(std::uint32_t particle) const;
  /// Mass of all particles that are tied to a representative [kg]; 0: fixed.
  float mass(std::uint32_t representative, const ParticleView& particles) const;
  /// Whether a representative is neither attached nor tied to others.
  bool is_alone(std::uint32_t representative) const;
  /// Calls f(particle, part of the mass) for those that are tied to a representative. A fixed one moves as its
  /// representative alone.
  template <class Function>
  void for_each(std::uint32_t representative, const ParticleView& particles, const Function& f) const {
    const float all = mass(representative, particles);
    for_each_of(representative, [&](std::uint32_t i) {
      f(i, all > 0 ? 1 / (particles.inverse_mass(i) * all) : i == representative ? 1.0f : 0.0f);
    });
  }
  /// Calls f(particle, representative) for all that are tied.
  template <class Function>
  void for_each_tied(const Function& f) const {
    for (const auto& [particle, representative] : tied_) f(particle, representative);
  }
  bool has_attached() const { return !attached_.empty(); }

  bool operator==(const TiedParticles&) const = default;

 private:
  template <class Function>
  void for_each_of(std::uint32_t representative, const Function& f) const {
    auto at = std::lower_bound(groups_.begin(), groups_.end(), std::pair(representative, std::uint32_t{0}));
    if (at == groups_.end() || at->first != representative) return f(representative);
    for (; at != groups_.end() && at->first == representative; ++at) f(at->second);
  }
  bool is_fixed(std::uint32_t particle, const ParticleView& particles) const;

  std::vector<std::uint32_t> attached_;                          // ascending
  std::vector<std::pair<std::uint32_t, std::uint32_t>> tied_;    // (particle, representative), sorted
  std::vector<std::pair<std::uint32_t, std::uint32_t>> groups_;  // (representative, particle), sorted
};

}  // namespace souple
