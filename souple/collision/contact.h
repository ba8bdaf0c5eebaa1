#pragma once

#include "souple/math/vec3.h"

#include <cstdint>

// What contact projectors have in common.

namespace souple {

/// An object as contacts see it: a range of particles with one surface. An object's index in the span given
/// to begin_step is its row (and column) in the ContactMaterialTable, which may keep two of them apart. Ranges are
/// disjoint and ascending.
struct ContactObject {
  std::uint32_t begin = 0, end = 0;  ///< particles [begin, end)
  bool moves = true;                 ///< two that do not are not compared, nor one with itself
  bool collides_with_colliders = true;
  bool self_collision = false;  ///< its particles against each other
  std::uint32_t groups = 1;     ///< particles of two objects meet when a.groups & b.mask and
  std::uint32_t mask = 0;       ///<   b.groups & a.mask are both non-zero
};

/// The whole step, known before its first substep.
struct ContactStep {
  double time = 0;        ///< at the step's begin [s]
  float dt = 0;           ///< its length [s]
  float gravity = 9.81f;  ///< |g| [m/s^2]: approach slower than 2 |g| h does not bounce
  /// How fast an overlap that was there before the substep is pushed out. [m/s]
  float depenetration_speed = 3.f;
  float h = 0;  ///< the length of its substeps; 0: there is one [s]
};

/// One contact that pushed during the last substep.
struct ContactPush {
  std::uint32_t particle = 0;
  std::uint32_t other = 0;  ///< collider index, or second particle
  Vec3f point{};            ///< on the surface, world space [m]
  Vec3f normal{};           ///< unit, towards `particle`
  float impulse = 0;        ///< normal impulse on `particle` [N s]
};

struct ContactReport {
  std::size_t count = 0;  ///< contacts that pushed during the last substep
  float deepest = 0;      ///< largest penetration left after it [m]
};

/// Of contacts that know how far they `pushed` and what `depth` is left.
template <class Contacts>
ContactReport report_of(const Contacts& contacts) {
  ContactReport report;
  for (const auto& contact : contacts) {
    if (!(contact.normal_sum > 0)) continue;
    ++report.count;
    report.deepest = max(report.deepest, contact.depth);
  }
  return report;
}

}  // namespace souple
