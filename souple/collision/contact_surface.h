#pragma once

#include "souple/geometry/adjacency.h"
#include "souple/math/vec3.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace souple {

/// What an object shows to others: triangles, loose edges and loose vertices over its particles. Spans live
/// as long as whoever was given it uses them.
struct ContactSurface {
  std::uint32_t begin = 0, end = 0;  ///< particles [begin, end)
  std::uint32_t reserved_end = 0;    ///< loose ones may come up to here; 0: up to `end`
  std::span<const std::array<std::uint32_t, 3>> triangles{};  ///< of particles, counted from `begin`
  std::span<const Edge> edges{};
  bool particles_only = false;  ///< grains: every particle is a ball of its radius
  bool self_collision = false;  ///< triangles and edges of this object against each other
  std::uint32_t groups = 1;     ///< two objects meet when a.groups & b.meets and b.groups & a.meets
  std::uint32_t mask = ~0u;     ///< are both non-zero
  bool immovable = false;       ///< an obstacle: nothing could move two of them apart
  int layer = 0;  ///< the higher of two lies outside of the lower; 0: there is no order (layers.h)
  std::vector<std::uint32_t> ignored_surfaces{};  ///< surfaces that it never meets, ascending
  std::span<const Vec3d> rest{};  ///< of its particles: features near at rest may stay as near
};

/// Whether triangles, edges and balls of two of them are to be kept apart, or of one with itself.
inline bool may_collide(std::span<const ContactSurface> surfaces, std::size_t a, std::size_t b) {
  const ContactSurface &one = surfaces[a], &other = surfaces[b];
  if (a == b) return one.self_collision;
  if (one.particles_only && other.particles_only) return false;  // see ParticleContacts
  if (one.immovable && other.immovable) return false;
  if (std::binary_search(one.ignored_surfaces.begin(), one.ignored_surfaces.end(), b)) return false;
  return (one.groups & other.mask) != 0 && (other.groups & one.mask) != 0;
}

}  // namespace souple
