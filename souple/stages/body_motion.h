#pragma once

#include "souple/math/elementary.h"
#include "souple/state/rigid_bodies.h"

namespace souple {

/// The velocity that leads from one pose to the other in h seconds.
inline BodyVelocity velocity_between(const BodyPose& from, const BodyPose& to, double h) {
  const Quatd turn = to.rotation * conjugate(from.rotation);
  const double sign = turn.w < 0 ? -1 : 1;
  const Vec3d axis{turn.x * sign, turn.y * sign, turn.z * sign};
  const double sine = length(axis);
  const double angle = 2 * elementary::atan2(sine, turn.w * sign);
  return {(to.position - from.position) / h, sine > 0 ? axis * (angle / (sine * h)) : Vec3d{}};
}

}  // namespace souple
