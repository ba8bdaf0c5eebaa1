#pragma once

#include "souple/collision/rigid_pose.h"
#include "souple/collision/shapes.h"
#include "souple/contacts/kernels/collider_contacts.h"
#include "souple/solver/projector.h"

// Colliders and particles as kernels/collider_contacts.h takes them.

namespace souple {

/// The shape around its center. `shape` must outlive the result.
kernels::ColliderShape packed_shape(const Shape& shape);

/// The point of a shape's own frame that is the origin of the kernels' frame: its center; 0 for planes and fields.
Vec3d center_of(const Shape& shape);

/// Sets a body's poses. `origin`, `axes`: the kernels' frame in the collider's own.
void set_poses(kernels::ColliderBody& body, const Vec3d& origin, const Mat3d& axes, const RigidPose& before,
               const RigidPose& after);

kernels::ColliderParticles packed_particles(const ParticleView& particles);

}  // namespace souple
