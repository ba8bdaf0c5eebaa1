#pragma once

#include "souple/rigid/free_motion.h"

#include <cmath>
#include <numbers>
#include <vector>

namespace souple {

/// Complete elliptic integral of the first kind, of modulus k: by the arithmetic-geometric mean.
inline double complete_elliptic(double k) {
  double a = 1, b = std::sqrt(1 - k * k);
  while (std::abs(a - b) > 1e-15) {
    const double mean = (a + b) / 2;
    b = std::sqrt(a * b), a = mean;
  }
  return std::numbers::pi / (2 * a);
}

/// A single body at rest at the origin.
inline RigidBodies one_body(double mass, const Vec3d& inertia) {
  RigidBodies bodies;
  bodies.resize(1);
  bodies.mass[0] = {1 / mass, {1 / inertia.x, 1 / inertia.y, 1 / inertia.z}};
  bodies.inverse_inertia[0] = world_inverse_inertia(bodies.mass[0], bodies.pose[0].rotation);
  return bodies;
}

/// A substep without constraints.
inline void move_freely(RigidBodies& bodies, const Vec3d& gravity, double h) {
  std::vector<BodyPose> predicted(bodies.size());
  predict_bodies(bodies, gravity, h, predicted);
  finish_bodies(bodies, predicted, h);
}

/// Angular velocity in the body's axes [rad/s].
inline Vec3d local_spin(const RigidBodies& bodies, std::size_t i = 0) {
  return bodies.pose[i].local_direction(bodies.velocity[i].angular);
}

/// Angular momentum about the center of mass, in world axes [kg m^2/s].
inline Vec3d spin_momentum(const RigidBodies& bodies, std::size_t i = 0) {
  const Vec3d w = local_spin(bodies, i), inverse = bodies.mass[i].inverse_inertia;
  return bodies.pose[i].direction({w.x / inverse.x, w.y / inverse.y, w.z / inverse.z});
}

/// Energy of rotation [J].
inline double spin_energy(const RigidBodies& bodies, std::size_t i = 0) {
  return 0.5 * dot(spin_momentum(bodies, i), bodies.velocity[i].angular);
}

}  // namespace souple
