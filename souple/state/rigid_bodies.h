#pragma once

#include "souple/math/mat3.h"
#include "souple/math/quaternion.h"

#include <cstddef>
#include <vector>

namespace souple {

/// Placement of a rigid body in the world. Its local frame has its origin at the center of mass, and principal axes.
struct BodyPose {
  Vec3d position{};  ///< of the center of mass [m]
  Quatd rotation{};  ///< local to world

  Vec3d direction(const Vec3d& local) const { return rotate(rotation, local); }
  Vec3d point(const Vec3d& local) const { return position + direction(local); }
  Vec3d local_direction(const Vec3d& world) const { return rotate(conjugate(rotation), world); }
  Vec3d local_point(const Vec3d& world) const { return local_direction(world - position); }
};

struct BodyVelocity {
  Vec3d linear{};   ///< of the center of mass [m/s]
  Vec3d angular{};  ///< in world axes [rad/s]

  /// Velocity of the body's point at center + r [m/s].
  Vec3d at(const Vec3d& r) const { return linear + cross(angular, r); }
};

/// 0 everywhere: forces do not move the body.
struct BodyMass {
  double inverse = 0;       ///< 1/kg
  Vec3d inverse_inertia{};  ///< about the principal axes [1/(kg m^2)]
};

/// All rigid bodies of a world, as plain arrays of equal length.
struct RigidBodies {
  std::vector<BodyMass> mass;
  std::vector<BodyPose> pose;   ///< during a substep: predicted
  std::vector<BodyPose> start;  ///< when the substep began
  std::vector<BodyVelocity> velocity;
  std::vector<Mat3d> inverse_inertia;  ///< in world axes, of the predicted pose [1/(kg m^2)]

  std::size_t size() const { return pose.size(); }
  void resize(std::size_t count) {
    mass.resize(count), pose.resize(count), start.resize(count), velocity.resize(count);
    inverse_inertia.resize(count);
  }
};

}  // namespace souple
