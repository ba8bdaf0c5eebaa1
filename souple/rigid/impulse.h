#pragma once

#include "souple/state/rigid_bodies.h"

#include <cstdint>
#include <span>

// How impulses move a rigid body. Müller et al. 2020, "Detailed Rigid Body Simulation with Extended Position Based
// Dynamics", section 3.3. Positional impulses are forces times h^2 [kg m] and change poses; impulses are forces times h
// [kg m/s] and change velocities. `r` is from the body's center of mass to the point of action, in world axes [m].

namespace souple {

/// In place of a body: the world, which nothing moves.
inline constexpr std::uint32_t no_body = ~std::uint32_t{0};

/// Whether forces move a body.
inline bool moves(const RigidBodies& bodies, std::uint32_t body) {
  return body != no_body && bodies.mass[body].inverse > 0;
}

/// [r], the matrix of the cross product: [r] v = r x v.
inline Mat3d cross_matrix(const Vec3d& r) {
  return {{0, r.z, -r.y}, {-r.z, 0, r.x}, {r.y, -r.x, 0}};
}

/// dx / p at a point: K = 1/m - [r] I^-1 [r]. [1/kg]
inline Mat3d inverse_mass_at(const RigidBodies& bodies, std::uint32_t body, const Vec3d& r) {
  if (body == no_body) return {};
  const Mat3d R = cross_matrix(r);
  const double w = bodies.mass[body].inverse;
  return Mat3d::diagonal({w, w, w}) - R * (bodies.inverse_inertia[body] * R);
}

/// q turned by the rotation vector theta, in world axes: the unit quaternion along (theta / 2, 1) q. The angle is
/// 2 atan(|theta| / 2), which differs from |theta| in the third order and needs no trigonometry.
inline Quatd turned(const Quatd& q, const Vec3d& theta) {
  return normalized(Quatd{theta.x * 0.5, theta.y * 0.5, theta.z * 0.5, 1} * q);
}

/// Applies a positional impulse [kg m] to a body's pose.
inline void push(RigidBodies& bodies, std::uint32_t body, const Vec3d& r, const Vec3d& impulse) {
  if (body == no_body) return;
  BodyPose& pose = bodies.pose[body];
  pose.position += impulse * bodies.mass[body].inverse;
  pose.rotation = turned(pose.rotation, bodies.inverse_inertia[body] * cross(r, impulse));
}

/// Applies an angular positional impulse, torque times h^2 [kg m^2], to a body's pose.
inline void turn(RigidBodies& bodies, std::uint32_t body, const Vec3d& impulse) {
  if (body == no_body) return;
  BodyPose& pose = bodies.pose[body];
  pose.rotation = turned(pose.rotation, bodies.inverse_inertia[body] * impulse);
}

/// Applies an impulse [N s] to a body's velocity.
inline void push_velocity(RigidBodies& bodies, std::uint32_t body, const Vec3d& r, const Vec3d& impulse) {
  if (body == no_body) return;
  bodies.velocity[body].linear += impulse * bodies.mass[body].inverse;
  bodies.velocity[body].angular += bodies.inverse_inertia[body] * cross(r, impulse);
}

/// Applies an angular impulse [N m s] to a body's velocity.
inline void turn_velocity(RigidBodies& bodies, std::uint32_t body, const Vec3d& impulse) {
  if (body == no_body) return;
  bodies.velocity[body].angular += bodies.inverse_inertia[body] * impulse;
}

/// Center of mass [m].
inline Vec3d center_of(std::span<const BodyPose> poses, std::uint32_t body) {
  return body == no_body ? Vec3d{} : poses[body].position;
}

/// Velocity of the point at center + r [m/s].
inline Vec3d velocity_at(const RigidBodies& bodies, std::uint32_t body, const Vec3d& r) {
  return body == no_body ? Vec3d{} : bodies.velocity[body].at(r);
}

}  // namespace souple
