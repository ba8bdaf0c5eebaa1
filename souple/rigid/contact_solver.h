#pragma once

#include "souple/rigid/contact_energy.h"
#include "souple/rigid/contact_islands.h"
#include "souple/rigid/contact_newton.h"
#include "souple/rigid/impacts.h"
#include "souple/threads/threads.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace souple {

/// Contacts between rigid bodies, in a substep:
///
///   bounce      before the prediction: velocities of bodies that bounce off each other
///   solve       after the prediction: poses. Again after others have moved bodies, as often as one likes.
///
/// `solve` finds equal and opposite impulses, so momentum and angular momentum are exact. It begins with the impulses
/// of the last substep and sweeps over contacts until they change little (projected Gauss-Seidel: Moreau and Jean 1996;
/// Catto 2005). An island that is small, or nearly at rest and not too large, is solved at once by Newton's method.
class ContactSolver {
 public:
  /// Call when the list of contacts has changed.
  void prepare(std::span<const RigidContact> contacts, const RigidBodies& bodies);
  void bounce(std::span<const RigidContact> contacts, RigidBodies& bodies, const RigidSubstep& substep);
  /// chosen[i] == 0: body i is left alone, unless it is in an island with a chosen one. Empty: all are chosen.
  void solve(std::span<RigidContact> contacts, RigidBodies& bodies, const RigidSubstep& substep,
             Threads& threads, std::span<const std::uint8_t> chosen = {});

  /// The largest depth [m].
  static double deepest(std::span<const RigidContact> contacts, const RigidBodies& bodies);
  std::size_t bytes() const;

 private:
  void begin(std::span<RigidContact> contacts, const RigidBodies& bodies, const RigidSubstep& substep,
             Threads& threads);
  void apply_last_impulses();
  void choose(std::span<const std::uint8_t> chosen);
  bool is_chosen(const ContactBlock& block) const { return chosen_[block.moves_a ? block.a : block.b] != 0; }
  void solve_island(std::size_t island, const RigidSubstep& substep, Threads& threads);
  double residual(std::span<const std::uint32_t> contacts) const;
  bool solve_at_once(std::size_t island, double limit);
  double sweep(const ContactIslands::Island& island, bool forward, Threads& threads);
  double sweep_colors(const ContactIslands::Island& island, bool forward, Threads& threads);

  Impacts impacts_;
  bool begun_ = false;                // blocks_ are those of this substep
  std::vector<ContactBody> states_;   // per body, and one that does not move
  std::vector<ContactBody> before_;   // when `solve` was called
  std::vector<ContactBlock> blocks_;  // of contacts with points
  std::vector<double> changes_;       // per block: in the last sweep, in a large island [m]
  ContactIslands islands_;
  ContactEnergy energy_;
  std::vector<ContactNewton> newton_;  // per island
  std::vector<double> budgets_;        // at the lowest body of an island: multiplications left in this step
  std::vector<std::uint8_t> chosen_;   // per body: in an island that is solved
  std::vector<std::uint32_t> local_;   // per body: scratch memory of newton_
};

}  // namespace souple
