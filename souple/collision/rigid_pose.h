#pragma once

#include "souple/collision/collider_motion.h"
#include "souple/math/mat3.h"

namespace souple {

/// Pose of a collider at a time, with a rotation matrix: world point = rotation local point + translation.
struct RigidPose {
  Mat3d rotation;
  Vec3d translation;

  Vec3d to_world(const Vec3d& local) const { return rotation * local + translation; }
  Vec3d to_local(const Vec3d& world) const {
    const Vec3d d = world - translation;
    return {dot(rotation.column[0], d), dot(rotation.column[1], d), dot(rotation.column[2], d)};
  }
};

/// Throws whatever ColliderMotion::at throws.
inline RigidPose pose_at(const ColliderMotion& motion, double time) {
  const Transform pose = motion.at(time);
  return {rotation_matrix(pose.rotation), pose.translation};
}

/// Poses at a substep's start and end. Where a loop restarts within the substep, both are the pose at its
/// end.
struct PosesOfSubstep {
  RigidPose before, after;
};

inline PosesOfSubstep poses_between(const ColliderMotion& motion, double begin, double end) {
  const RigidPose after = pose_at(motion, end);
  return {motion.jumps(begin, end) ? after : pose_at(motion, begin), after};
}

}  // namespace souple
