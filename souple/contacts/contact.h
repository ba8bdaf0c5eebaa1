#pragma once

#include "souple/collision/contact_step.h"
#include "souple/math/vec3.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <tuple>
#include <vector>

// Types that all contact projectors share.

namespace souple {

/// An object in contact detection: a range of particles with one contact material. Its index in the span that
/// begin_step takes is its row (and column) in the ContactMaterialTable, which may disable a pair of objects.
/// Ranges are disjoint and ascending.
struct ContactObject {
  std::uint32_t begin = 0, end = 0;  ///< particles [begin, end)
  bool still = false;                ///< it did not move in the last step, and does not in this one
  bool moves = true;  ///< pairs of objects that do not move are skipped; so is such an object with itself
  bool collides_with_colliders = true;
  bool self_collision = false;  ///< between particles of this object
  bool are_balls = false;       ///< its particles collide with those of other objects of balls
  bool rolls = false;           ///< its particles are solid balls that rotate, such as grains
};

/// One contact that applied a normal impulse during the last substep.
struct ContactPush {
  std::uint32_t particle = 0;
  std::uint32_t other = 0;  ///< index of the collider or of the second particle
  Vec3f point{};            ///< point of contact on the surface, world space [m]
  Vec3f normal{};           ///< unit, towards `particle`
  float impulse = 0;        ///< normal impulse on `particle` [N s]
  bool against_collider = false;
};

/// A contact that pushes, with restitution, whose sides approached each other.
struct Impact {
  static constexpr std::uint32_t collider = 0xffffffff;
  std::uint32_t particle = 0;
  std::uint32_t other = 0;   ///< a particle of the second side, or `collider`
  Vec3f normal{};            ///< unit, towards `particle`
  float approach = 0;        ///< speed of the predicted motion along the normal [m/s]
  float restitution = 0;     ///< coefficient
  Vec3f surface_velocity{};  ///< of the collider [m/s]
};

/// Impulses of one contact in a substep: motions times masses [kg m].
struct ContactImpulse {
  static constexpr std::size_t most = 7;  ///< particles
  std::array<std::uint32_t, most> particle{};
  std::array<Vec3f, most> impulse{};
  std::size_t count = 0;
  bool by_collider = false;  ///< else the sum is 0
  Vec3f moment{};            ///< on the ball of the first particle, over its radius [kg m]
};

/// Motion of a free particle out of the way of a rigid body, which the body has not felt yet.
struct BodyPush {
  std::uint32_t object = 0;  ///< index of the body's object
  std::uint32_t particle = 0;
  Vec3f moved{};  ///< [m]
};

/// Two objects that stopped one particle between them. `other` cannot move, or is a rigid body like `body`.
struct Pinch {
  std::uint32_t body = 0, other = 0;  ///< indices of objects
};

/// The fastest motion that was shortened because contacts cannot follow it, or because it was driven into something that
/// cannot give way.
struct ShortenedMotion {
  std::uint32_t object = 0;  ///< index of the particle's object
  float speed = 0;           ///< [m/s]; 0: no motion was shortened
  float limit = 0;           ///< speed that remained, relative to what moves with it [m/s]; 0: it was stopped
};

/// Sorts the pushes from `first` on by particles. A stable sort would allocate: pushes of the same particles are in order of
/// their points.
inline void sort_pushes(std::vector<ContactPush>& pushes, std::size_t first) {
  const auto key = [](const ContactPush& push) {
    return std::tie(push.particle, push.other, push.point.x, push.point.y, push.point.z, push.impulse);
  };
  std::sort(pushes.begin() + static_cast<std::ptrdiff_t>(first), pushes.end(),
            [&](const ContactPush& a, const ContactPush& b) { return key(a) < key(b); });
}

struct ContactReport {
  std::size_t count = 0;  ///< contacts with a normal impulse in the last substep
  float deepest = 0;      ///< largest penetration left after the last substep [m]
};

/// Report of contacts 0 to count - 1, given their sums of normal corrections and the depth that is left.
template <class NormalSum, class Depth>
ContactReport summarize(std::size_t count, const NormalSum& normal_sum, const Depth& depth) {
  ContactReport report;
  for (std::size_t c = 0; c < count; ++c) {
    if (!(normal_sum(c) > 0)) continue;
    ++report.count;
    report.deepest = max(report.deepest, depth(c));
  }
  return report;
}

/// Report of contacts that have `sums` and a `depth`.
template <class Contacts>
ContactReport report_of(const Contacts& contacts) {
  return summarize(
      contacts.size(), [&](std::size_t c) { return contacts[c].sums.normal_sum; },
      [&](std::size_t c) { return contacts[c].depth; });
}

/// Report of columns.
inline ContactReport report_of(std::size_t count, const float* normal_sum, const float* depth) {
  return summarize(
      count, [=](std::size_t c) { return normal_sum[c]; }, [=](std::size_t c) { return depth[c]; });
}

}  // namespace souple
