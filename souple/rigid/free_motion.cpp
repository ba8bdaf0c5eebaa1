#include "souple/rigid/free_motion.h"

#include "souple/assert.h"
#include "souple/rigid/impulse.h"

namespace souple {
namespace {

/// The rotation by about `angle` about a principal axis: tan(angle / 2) to the third order, without trigonometry. It
/// depends on the momentum about this axis alone, so the composition stays symplectic.
Quatd about_axis(int axis, double angle) {
  Quatd q{0, 0, 0, 1};
  (axis == 0 ? q.x : (axis == 1 ? q.y : q.z)) = angle * (0.5 + angle * angle / 24);
  return normalized(q);
}

/// Turns the body about a principal axis for `h` seconds by the part L_k^2 / (2 I_k) of its energy. `momentum`: angular,
/// in local axes, constant in world axes.
void spin_about(int axis, double inverse_inertia, double h, Quatd& rotation, Vec3d& momentum) {
  const Quatd q = about_axis(axis, momentum[axis] * inverse_inertia * h);
  rotation = rotation * q;
  momentum = rotate(conjugate(q), momentum);
}

Vec3d reciprocal(const Vec3d& v) {
  const auto inverse = [](double x) { return x > 0 ? 1 / x : 0.0; };
  return {inverse(v.x), inverse(v.y), inverse(v.z)};
}

/// The spin that keeps the angular momentum of `angular` after a body was turned: its inertia turned with it.
Vec3d carried_spin(const BodyMass& mass, const Quatd& before, const Quatd& after, const Vec3d& angular) {
  const Vec3d& w = mass.inverse_inertia;
  const Vec3d inertia = reciprocal(w), local = rotate(conjugate(before), angular);
  const Vec3d L =
      rotate(conjugate(after) * before, Vec3d{local.x * inertia.x, local.y * inertia.y, local.z * inertia.z});
  return rotate(after, Vec3d{L.x * w.x, L.y * w.y, L.z * w.z});
}

}  // namespace

Vec3d rotation_between(const Quatd& before, const Quatd& after) {
  const Quatd d = after * conjugate(before);
  return Vec3d{d.x, d.y, d.z} * (2 / d.w);
}

Mat3d world_inverse_inertia(const BodyMass& mass, const Quatd& rotation) {
  const Mat3d R = rotation_matrix(rotation);
  const Vec3d& w = mass.inverse_inertia;
  return Mat3d{R.column[0] * w.x, R.column[1] * w.y, R.column[2] * w.z} * transpose(R);
}

void rotate_freely(const BodyMass& mass, double h, Quatd& rotation, Vec3d& angular) {
  const Vec3d& w = mass.inverse_inertia;
  const Vec3d local = rotate(conjugate(rotation), angular), inertia = reciprocal(w);
  Vec3d L{local.x * inertia.x, local.y * inertia.y, local.z * inertia.z};
  spin_about(0, w.x, h / 2, rotation, L);
  spin_about(1, w.y, h / 2, rotation, L);
  spin_about(2, w.z, h, rotation, L);
  spin_about(1, w.y, h / 2, rotation, L);
  spin_about(0, w.x, h / 2, rotation, L);
  rotation = normalized(rotation);
  angular = rotate(rotation, Vec3d{L.x * w.x, L.y * w.y, L.z * w.z});
}

void predict_bodies(RigidBodies& bodies, const Vec3d& gravity, double h, std::span<BodyPose> predicted) {
  SOUPLE_ASSERT(predicted.size() == bodies.size(), "one predicted pose a body");
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    BodyPose& pose = bodies.pose[i];
    bodies.start[i] = pose;
    BodyVelocity& v = bodies.velocity[i];
    if (bodies.mass[i].inverse > 0) {
      v.linear += gravity * h;
      rotate_freely(bodies.mass[i], h, pose.rotation, v.angular);
    } else {
      pose.rotation = turned(pose.rotation, v.angular * h);
    }
    pose.position += v.linear * h;
    bodies.inverse_inertia[i] = world_inverse_inertia(bodies.mass[i], pose.rotation);
    predicted[i] = pose;
  }
}

void finish_bodies(RigidBodies& bodies, std::span<const BodyPose> predicted, double h) {
  SOUPLE_ASSERT(predicted.size() == bodies.size(), "one predicted pose a body");
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (!(bodies.mass[i].inverse > 0)) continue;
    const BodyPose& pose = bodies.pose[i];
    bodies.velocity[i].linear += (pose.position - predicted[i].position) / h;
    const Vec3d turn = rotation_between(predicted[i].rotation, pose.rotation) / h;
    bodies.velocity[i].angular =
        carried_spin(bodies.mass[i], predicted[i].rotation, pose.rotation, bodies.velocity[i].angular + turn);
  }
}

}  // namespace souple
