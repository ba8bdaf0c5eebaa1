#pragma once

#include "souple/broad_phase/collision_filter.h"
#include "souple/geometry/adjacency.h"
#include "souple/math/vec3.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace souple {

/// The ball, capsule or cylinder that the triangles of a rigid body approximate.
struct RoundShape {
  std::array<std::uint32_t, 4> particle{};  ///< relative to `begin`; no plane contains all four
  std::array<std::array<float, 4>, 2>
      axis{};                ///< its ends as sums of these particles; those of a ball are equal
  float radius = 0;          ///< 0: no such shape [m]
  float sagitta = 0;         ///< by which the triangles lie below the surface [m]
  bool is_cylinder = false;  ///< its ends are flat
};

/// Contact geometry of an object: triangles, edges without triangles, or particles alone. The spans must
/// outlive all users of the struct.
struct ContactSurface {
  std::uint32_t begin = 0, end = 0;  ///< particles [begin, end)
  std::uint32_t reserved_end = 0;    ///< end of the range for particles added later; 0: `end`
  std::span<const std::array<std::uint32_t, 3>> triangles{};  ///< indices of particles, relative to `begin`
  std::span<const Edge> edges{};                              ///< without triangles, such as those of ropes
  bool particles_only = false;  ///< no triangles or edges: every particle is a ball of its radius
  bool self_collision = false;  ///< between triangles and edges of this object
  bool vertex_balls = false;    ///< between balls at its vertices instead (vertex_balls.h)
  CollisionFilter filter{};     ///< with which other objects
  bool immovable = false;       ///< an obstacle: no contact can move it, so two of them are not compared
  int layer = 0;  ///< the surface with the higher layer lies outside of the lower one; 0: no order (layers.h)
  std::vector<std::uint32_t> ignored_surfaces{};  ///< indices of surfaces it never collides with, ascending
  /// Rest position of each particle [m]: elements that are near at rest may stay as near.
  std::span<const Vec3d> rest{};
  bool rigid = false;  ///< a rigid body
  RoundShape round{};  ///< of a rigid body
  bool keeps_shape =
      false;           ///< a rigid body or obstacle: two of them are not compared, see rigid/contact_finder.h
  bool rolls = false;  ///< its particles are solid balls that rotate; only with particles_only
  float radius = 1;    ///< of the object at rest, see ContactStep::depenetration_speed [m]
};

/// Pairs of particles that never touch, such as those of a distance joint. All particles of a rigid body are one.
class ParticlePairs {
 public:
  ParticlePairs() = default;
  /// `bodies`: ranges [begin, end) of particles, for each of which its first one stands.
  explicit ParticlePairs(std::vector<Edge> pairs, std::vector<Edge> bodies = {});
  bool empty() const { return pairs_.empty(); }
  bool contains(std::uint32_t i, std::uint32_t j) const {
    if (empty()) return false;
    const std::uint32_t a = first_of(i), b = first_of(j);
    return std::binary_search(pairs_.begin(), pairs_.end(), Edge{std::min(a, b), std::max(a, b)});
  }
  /// Ascending, and so is each pair.
  const std::vector<Edge>& sorted() const { return pairs_; }

 private:
  std::uint32_t first_of(std::uint32_t particle) const {
    const auto next = std::upper_bound(bodies_.begin(), bodies_.end(), Edge{particle, ~std::uint32_t{0}});
    return next != bodies_.begin() && particle < (next - 1)->back() ? (next - 1)->front() : particle;
  }

  std::vector<Edge> pairs_, bodies_;  // ascending
};

/// Whether any of them collides with another one or with itself.
bool any_may_collide(std::span<const ContactSurface> surfaces);

/// Whether surface a collides with surface b; where a == b, whether it has self-collision.
inline bool may_collide(std::span<const ContactSurface> surfaces, std::size_t a, std::size_t b) {
  const ContactSurface &one = surfaces[a], &other = surfaces[b];
  if (a == b) return one.self_collision;
  if (one.particles_only && other.particles_only) return false;  // see ParticleContacts
  if ((one.immovable && other.immovable) || (one.keeps_shape && other.keeps_shape)) return false;
  if (std::binary_search(one.ignored_surfaces.begin(), one.ignored_surfaces.end(), b)) return false;
  return may_collide(one.filter, other.filter);
}

}  // namespace souple
