#pragma once

#include "souple/collision/rigid_pose.h"
#include "souple/collision/shapes.h"
#include "souple/contacts/collider.h"
#include "souple/contacts/kernels/collider_contacts.h"
#include "souple/contacts/motion_margins.h"
#include "souple/solver/projector.h"

// Colliders and particles as kernels/collider_contacts.h takes them.

namespace souple {

/// The shape around its center. `shape` must outlive the result.
kernels::ColliderShape packed_shape(const Shape& shape);

/// The point of a shape's own frame that is the origin of the kernels' frame: its center; 0 for planes and fields.
Vec3d center_of(const Shape& shape);

/// A collider during a step, as kernels see it.
struct PackedCollider {
  std::uint32_t collider = 0;
  // The frame that kernels use, in the collider's own: see kernels/collider_contacts.h.
  Vec3d origin{};
  Mat3d axes = Mat3d::identity();
  RigidPose before, after;  // at the start and end of the substep
  kernels::ColliderBody packed;
  ColliderMargin margin;  // if it moves

  PackedCollider() = default;
  PackedCollider(std::uint32_t index, const Collider& collider);
  void set_pose(const RigidPose& at_start, const RigidPose& at_end);
  /// Moves it through the substep of length h from `time` on.
  void follow(const ColliderMotion& motion, double time, float h);
  /// Whether it goes beyond its margin in the substep.
  bool leaves() const { return packed.moves && margin.left(before, after); }
};

kernels::ColliderParticles packed_particles(const ParticleView& particles);

}  // namespace souple
