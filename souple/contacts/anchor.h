#pragma once

#include "souple/contacts/contact.h"
#include "souple/solver/projector.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace souple {

/// Point on which a contact acts: sum_k c_k p_k of n particles. It is a point of an element (sum_k c_k = 1) that a
/// collider pushes, or a point relative to that of another element (sum_k c_k = 0). Nothing else about a contact
/// depends on the number of its particles.
template <std::size_t n>
struct Anchor {
  std::array<std::uint32_t, n> particle{};
  std::array<float, n> weight{};  ///< c_k

  /// sum_k c_k f(particle k), f a vector.
  template <class Function>
  Vec3f sum(const Function& f) const {
    Vec3f result = f(particle[0]) * weight[0];
    for (std::size_t k = 1; k < n; ++k) result += f(particle[k]) * weight[k];
    return result;
  }
  /// Motion since the substep began [m].
  Vec3f moved(const ParticleView& particles) const {
    return sum([&](std::uint32_t i) { return particles.moved(i); });
  }
  /// [m/s]
  Vec3f velocity(std::span<const Vec4f> velocity) const {
    return sum([&](std::uint32_t i) { return velocity[i].xyz(); });
  }
  /// 1 / effective mass: sum_k c_k^2 / m_k [1/kg].
  float inverse_mass(const ParticleView& particles) const {
    float result = 0;
    for (std::size_t k = 0; k < n; ++k) result += weight[k] * weight[k] * particles.inverse_mass(particle[k]);
    return result;
  }
  /// Calls f(particle, part of the change): the sum changes by `change` if particle k changes by
  /// change c_k / m_k / sum_j (c_j^2 / m_j). Immovable particles are left out: other threads may read them.
  template <class Function>
  void distribute(const ParticleView& particles, const Vec3f& change, float inverse_mass,
                  const Function& f) const {
    for (std::size_t k = 0; k < n; ++k) {
      const float factor = weight[k] * particles.inverse_mass(particle[k]) / inverse_mass;
      if (abs(factor) > 0) f(particle[k], change * factor);
    }
  }
  /// Impulses c_k change / sum_j (c_j^2 / m_j) [kg m].
  ContactImpulse impulse(const Vec3f& change, float inverse_mass) const {
    static_assert(n <= ContactImpulse::most);
    ContactImpulse result;
    for (std::size_t k = 0; k < n; ++k) {
      if (!(abs(weight[k]) > 0)) continue;
      result.particle[result.count] = particle[k];
      result.impulse[result.count++] = change * (weight[k] / inverse_mass);
    }
    return result;
  }
  /// Moves the point by `change` [m].
  void correct(const ParticleView& particles, const Vec3f& change, float inverse_mass) const {
    distribute(particles, change, inverse_mass,
               [&](std::uint32_t i, const Vec3f& dx) { particles.correct(i, dx); });
  }
  /// Changes the velocity of the point by `change` [m/s].
  void accelerate(std::span<Vec4f> velocity, const ParticleView& particles, const Vec3f& change,
                  float inverse_mass) const {
    distribute(particles, change, inverse_mass,
               [&](std::uint32_t i, const Vec3f& dv) { velocity[i].set_xyz(velocity[i].xyz() + dv); });
  }
};

/// Ball i relative to ball j.
inline Anchor<2> between(std::uint32_t i, std::uint32_t j) {
  return {{i, j}, {1, -1}};
}

}  // namespace souple
