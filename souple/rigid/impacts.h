#pragma once

#include "souple/math/lists.h"
#include "souple/rigid/rigid_contact.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace souple {

/// A substep of rigid contacts.
struct RigidSubstep {
  double h = 0;                    ///< [s]
  int iterations = 1;              ///< multiplies the largest number of sweeps over contacts
  double depenetration_speed = 1;  ///< at which older overlaps are removed [m/s]
  double bounce_speed = 0;         ///< contacts that approach more slowly are no impacts [m/s]
  Vec3d gravity{};                 ///< [m/s^2]
};

/// Impacts with restitution: velocities before the prediction of a substep.
class Impacts {
 public:
  /// Call when the list of contacts has changed.
  void prepare(std::span<const RigidContact> contacts, const RigidBodies& bodies);
  /// Gives the sides of every contact with restitution e times their approach speed, with friction, until none
  /// approaches. This concerns contacts that close within the substep faster than the bounce speed. So an impact
  /// travels through a row of balls.
  void bounce(std::span<const RigidContact> contacts, RigidBodies& bodies, const RigidSubstep& substep);
  std::size_t bytes() const;

 private:
  /// Whether a contact's sides hit each other.
  static bool collide(const RigidContact& contact, RigidBodies& bodies, const RigidSubstep& substep);
  void look_again(std::uint32_t body);

  Lists<std::uint32_t> contacts_of_;                   // per body that moves
  std::vector<std::uint32_t> impacts_, next_impacts_;  // contacts to look at
  std::vector<std::uint8_t> waits_;                    // per contact: is in next_impacts_
};

}  // namespace souple
