#pragma once

#include "souple/state/rigid_bodies.h"

#include <span>

// The motion of rigid bodies between impulses, and how velocities follow from poses.

namespace souple {

/// I^-1 in world axes: R diag(I^-1) R^T. [1/(kg m^2)]
Mat3d world_inverse_inertia(const BodyMass& mass, const Quatd& rotation);

/// theta of the rotation `after` = (theta / 2, 1) `before`, inverse to `turned`.
Vec3d rotation_between(const Quatd& before, const Quatd& after);

/// Rotates a body without torque for h seconds. The angular momentum in world axes is constant and the energy error is
/// bounded. The method is a symmetric composition of rotations about the principal axes, each exact for its part of the
/// energy. Source: Dullweber, Leimkuhler and McLachlan 1997, "Symplectic splitting methods for rigid body molecular
/// dynamics", section 3. `angular`: in world axes, updated [rad/s].
void rotate_freely(const BodyMass& mass, double h, Quatd& rotation, Vec3d& angular);

/// The start of a substep: start = pose; v += h g for bodies with mass; then poses move freely for h seconds.
/// Velocities of bodies without mass are left alone. `predicted` receives the poses, for finish_bodies.
void predict_bodies(RigidBodies& bodies, const Vec3d& gravity, double h, std::span<BodyPose> predicted);

/// The end of a substep: v = v* + (x - x*) / h, and likewise for rotations, with the predicted poses x*. Impulses between
/// bodies keep the angular momentum: it belongs to the inertia of the predicted pose, the spin to that of the final one.
/// Velocities of bodies without mass are left alone.
void finish_bodies(RigidBodies& bodies, std::span<const BodyPose> predicted, double h);

}  // namespace souple
