#include "souple/objects/object.h"
#include "souple/rigid/free_motion.h"
#include "souple/stages/rigid_stage.h"
#include "souple/state/particles.h"

// Velocities of rigid bodies that users read and change, between steps and in callbacks.

namespace souple {
namespace {

Mat3d inverse_inertia(const RigidDefinition& body, const Quatd& rotation) {
  const Vec3d& I = body.inertia;
  return world_inverse_inertia({1 / body.mass, {1 / I.x, 1 / I.y, 1 / I.z}}, rotation);
}

}  // namespace

// A change of a particle's velocity times its mass is an impulse on the body, which takes it over at the next step.
BodyVelocity RigidStage::velocity_now(const Particles& particles, const Object& object) const {
  const Record& record = *find(object.id.value);
  const Mat3d R = rotation_matrix(record.pose.rotation);
  Vec3d impulse, moment;
  std::size_t i = object.begin;
  for (const Vec3d& local : record.definition.particles) {
    const Vec3d r = R * local;
    const Vec3f change = particles.velocity[i].xyz() - Vec3f(record.velocity.at(r));
    const auto w = static_cast<double>(particles.position[i].w);
    ++i;
    if (!(w > 0) || change == Vec3f{}) continue;
    impulse += Vec3d(change) / w, moment += cross(r, Vec3d(change) / w);
  }
  return {record.velocity.linear + impulse / record.definition.mass,
          record.velocity.angular + inverse_inertia(record.definition, record.pose.rotation) * moment};
}

void RigidStage::change_velocity(Particles& particles, const Object& object, const BodyVelocity& change) {
  Record& record = *find(object.id.value);
  const auto changed = [&](const BodyVelocity& v) {
    return BodyVelocity{v.linear + change.linear, v.angular + change.angular};
  };
  const BodyVelocity before = record.velocity, after = changed(before);
  const Mat3d R = rotation_matrix(record.pose.rotation);
  std::size_t i = object.begin;
  for (const Vec3d& local : record.definition.particles) {
    const Vec3d r = R * local;
    Vec4f& v = particles.velocity[i++];
    const Vec3f expected(before.at(r)), now(after.at(r));
    // Other changes of the particle's velocity stay.
    v.set_xyz(v.xyz() == expected ? now : v.xyz() + (now - expected));
  }
  record.velocity = after;
  const auto body = static_cast<std::size_t>(&record - records_.data());
  if (listed_) bodies_.velocity[body] = changed(bodies_.velocity[body]);
}

void RigidStage::apply_impulse(Particles& particles, const Object& object, const Vec3d& point,
                               const Vec3d& impulse, const Vec3d& angular_impulse) {
  const Record& record = *find(object.id.value);
  const Vec3d moment = cross(point - record.pose.position, impulse) + angular_impulse;
  change_velocity(
      particles, object,
      {impulse / record.definition.mass, inverse_inertia(record.definition, record.pose.rotation) * moment});
}

}  // namespace souple
