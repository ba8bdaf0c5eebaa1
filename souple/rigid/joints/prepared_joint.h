#pragma once

#include "souple/rigid/joints/joint.h"

#include <span>

namespace souple::joint {

/// The values of a row when the substep began, and one substep before.
struct RowHistory {
  double start = 0, before = 0;
};

/// Equation of a row for the solve: value - goal + alpha lambda = 0.
struct RowTarget {
  double goal = 0;   ///< m or rad
  double alpha = 0;  ///< 1/kg or 1/(kg m^2)
};

/// From a body's center of mass to the joint's point [m].
struct Arm {
  Vec3d before{}, start{}, predicted{};  ///< a substep before the start, at the start, and predicted
};

/// A joint during a substep.
struct PreparedJoint {
  Rows rows;  ///< gradients of this substep, and present values
  std::array<RowHistory, Rows::most> history{};
  std::array<RowTarget, Rows::most> target{};
  std::array<double, Rows::most> K{};       ///< change of each value by its own impulse
  std::array<double, Rows::most> change{};  ///< of lambda, in the present pass
  std::array<double, Rows::most> lambda{};  ///< before the present projection
  std::array<bool, Rows::most> solved{};  ///< lambda is unknown: neither 0 in a range, nor at a limited force
  double size = 0;                        ///< of the bodies [m]
  Arm arm_a{}, arm_b{};
  double inertia_a = 0, inertia_b = 0;  ///< largest inverse inertia across the arm [1/(kg m^2)]
  double stiffness = 0;                 ///< s, see `prepare`
  double turning = 0;                   ///< weight a of the arms at the end
  bool has_arms = false;                ///< arms may be means
  bool active = false;

  std::size_t count() const { return static_cast<std::size_t>(rows.count); }
};

/// Whether impulses move a body.
bool is_movable(const RigidBodies& bodies, std::uint32_t body);

/// Gradients, histories and warm impulses of a joint for a substep of `h`, from the bodies' start and predicted poses.
///
/// Impulses act along the gradients of the substep's start, while their sum removes the error at its end. This is SHAKE
/// (Ryckaert, Ciccotti and Berendsen 1977), which conserves momentum and bounds the energy. Impulses along the
/// gradients of the end, as in usual position-based dynamics, remove omega^2 h of a swing's energy per second. SHAKE is
/// unstable where a heavy load pulls at a light body: s = |p . r| / I > 4, with the positional impulse p at the arm r.
/// There, arms are means a r1 + b r0 + c r-: r1 at the end, r0 at the start and r- a substep before, as in
/// multilevel/tree_elimination.h. `weigh_arms` adds the stiffness that follows from r1. Bodies that turn by more than
/// half a radian per substep get their predicted gradients.
void prepare(const Joint& joint, JointState& state, const RigidBodies& bodies, double h,
             PreparedJoint& prepared);

/// s for the impulses of `state`.
double stiffness_of(const JointState& state, const PreparedJoint& prepared);

/// Chooses the arms for the impulses of `state`, those at the end alone for a jerk. Adds the stiffness of each body
/// against turning that follows from them, where the joint pulls outward:
///   a (p . r) (1 - r r^T / |r|^2)  [kg m^2]
void weigh_arms(const Joint& joint, const JointState& state, bool jerk, PreparedJoint& prepared,
                std::span<Mat3d> stiffness);

/// Which gradients the next pass takes: those of `prepare`, or those of the present poses.
enum class Gradients : std::uint8_t { prepared, present };

struct Refreshed {
  bool changed = false;  ///< which rows are solved
  double error =
      0;  ///< largest that remains of a solved row's equation, relative to the bodies' size or 1 rad
};

/// Updates values from the present poses, then which rows are at a limit.
Refreshed refresh(const Joint& joint, JointState& state, const RigidBodies& bodies, double h,
                  Gradients gradients, PreparedJoint& prepared);

/// Force and torque from the impulses of a substep; breaks the joint if they are too large.
void report(const Joint& joint, JointState& state, const PreparedJoint& prepared);

}  // namespace souple::joint
