#pragma once

#include "souple/rigid/contact_block.h"
#include "souple/rigid/contact_islands.h"
#include "souple/rigid/impacts.h"

#include <cstddef>
#include <span>
#include <vector>

namespace souple {

/// Keeps contacts from creating energy. Bodies may move by many times their size in a substep, or turn by more than a radian.
/// Linear rows are wrong there, and their impulses may double the energy of an island. They are then scaled by
///
///   s = -b / (2 c),   E(s) = a + b s + c s^2,
///
/// which gives the least energy that impulses in this proportion can. Momentum stays, and what still overlaps comes apart
/// later.
class ContactEnergy {
 public:
  /// `before`: states when the solution began; `states`: after it, changed where an island gained energy. Rows of such islands
  /// are scaled as well.
  void limit(ContactIslands& islands, const RigidBodies& bodies, const RigidSubstep& substep,
             std::span<const ContactBody> before, std::span<ContactBody> states,
             std::span<ContactBlock> blocks);
  std::size_t bytes() const;

 private:
  /// Kinetic energies times h^2 [J s^2].
  struct Energy {
    double a = 0, b = 0, c = 0;
    double allowed = 0;      ///< that overlaps and gravity may add
    bool is_driven = false;  ///< a body without mass moves, and may do work
    double scale = 1;        ///< s
  };
  std::vector<Energy> energies_;  // per island
};

}  // namespace souple
