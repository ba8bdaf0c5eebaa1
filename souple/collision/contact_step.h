#pragma once

#include "souple/collision/detection.h"
#include "souple/math/vec4.h"

#include <cmath>
#include <span>

namespace souple {

struct CrossingTest;

/// Data of a whole step, set before its first substep.
struct ContactStep {
  double time = 0;        ///< at the start of the step [s]
  float dt = 0;           ///< length of the step [s]
  float gravity = 9.81f;  ///< |g| [m/s^2]: contacts that approach slower than 2 |g| h do not bounce
  float h = 0;            ///< length of a substep; 0: the step has only one [s]
  Detection detection = Detection::continuous;  ///< between surfaces
  const CrossingTest* crossing_test = nullptr;  ///< of discrete detection
  bool placed = false;  ///< objects were added, placed or restored since the last step
  /// Rotation of the particles of objects that roll (Particles::turn); empty: none rolls.
  std::span<Vec4f> turn{};

  /// Speed at which an overlap older than the substep is removed, if the smaller side has the radius R [m/s]. It is the
  /// speed of a fall by R. Without gravity it is the speed of a fall on Earth.
  float depenetration_speed(float R) const { return std::sqrt(2 * pull() * R); }
  /// Duration of such a fall [s].
  float fall_time(float R) const { return std::sqrt(2 * R / pull()); }
  /// Contacts that approach slower do not bounce: the speed of a fall of two substeps of length `of_substep` [m/s].
  float restitution_threshold(float of_substep) const { return 2 * gravity * of_substep; }
  /// Sides that move by less in a substep stick to each other, or begin to slide [m].
  float sliding_threshold(float of_substep) const { return restitution_threshold(of_substep) * of_substep; }

 private:
  float pull() const { return gravity > 0 ? gravity : 9.81f; }
};

}  // namespace souple
