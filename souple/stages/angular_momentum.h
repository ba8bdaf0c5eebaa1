#pragma once

#include "souple/stages/rigid_sums.h"
#include "souple/stages/stage_view.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace souple {

class Contacts;
class RigidStage;
struct UserConstraint;

/// Keeps the angular momentum of what only its own constraints hold together.
///
/// The solver's corrections dp act along directions at the end of the substep, while the impulses m dp / h act on
/// positions x at its start. So internal constraints, though sum m dp = 0, brake what spins:
///
///   L' - L = sum m x cross dp / h,   d omega / dt = -omega^3 h
///
/// A group is a set of particles and rigid bodies that constraints, ties and joints connect with each other, and with
/// nothing else. `end_solve` measures what the solver changed of its L, less what contacts did. `finish` adds the rigid
/// rotation I^-1 (L - L') to its velocities, which changes no momentum. A group is left alone in a substep if it touches
/// something that cannot give way.
class AngularMomentum {
 public:
  /// In place of the second particle of a link: something that does not belong to any group.
  static constexpr std::uint32_t fixed = ~std::uint32_t{0};
  /// Pairs of particles that ties and joints connect. A rigid body is its first particle.
  using Links = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

  /// Whether groups were found with these links since `forget`.
  bool knows(const Links& links) const { return known_ && links == links_; }
  void forget() { known_ = false; }
  /// Finds the groups. `projectors`: all but contacts. A user's own constraint may hold its particles to anything.
  void find(const ObjectsView& objects, std::span<Projector* const> projectors,
            std::span<const UserConstraint> users, Links links);

  void leave_all();
  /// Finds what is free in this step.
  void begin_step(const StageView& stage, const RigidStage& bodies);
  /// Around the solver, and before motions are filtered. The substep is of h seconds.
  void begin_solve(const StageView& stage, const RigidStage& bodies, double h);
  void end_solve(const StageView& stage, const RigidStage& bodies, const Contacts& contacts, double h);
  /// After the new velocities.
  void finish(const StageView& stage, RigidStage& bodies);
  std::size_t bytes() const;

 private:
  struct Range {
    std::uint32_t begin, end, group;
  };
  struct Group {
    std::vector<std::uint32_t> bodies;  ///< ids of objects
    std::uint32_t first = 0;            ///< particle
    bool is_free = false;               ///< in this step: awake, and nothing is pinned
    bool held = false;                  ///< in this substep, by contacts
    Vec3d origin;                       ///< near it [m]
    Vec3d momentum;                     ///< angular, about the origin, before the solver [kg m^2/s]
    Vec3d center, spin;                 ///< of the rotation that `finish` adds

    bool turns() const { return is_free && !held; }
  };

  template <class Motion>
  void sum(const StageView& stage, const Motion& motion);
  Group* group_of(std::uint32_t particle);

  bool known_ = false, any_free_ = false;
  Links links_;
  std::vector<Group> groups_;
  std::vector<Range> ranges_;  ///< of particles, ascending, those of bodies included
  std::vector<Range> chunks_;  ///< of particles that are no body's, at most chunk_size each
  std::vector<RigidSums> of_chunk_, of_group_;
  std::vector<const Projector*> changing_;  ///< users' constraints that listed no particle
};

}  // namespace souple
