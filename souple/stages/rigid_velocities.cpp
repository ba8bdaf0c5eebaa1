#include "souple/objects/object.h"
#include "souple/objects/objects_view.h"
#include "souple/rigid/free_motion.h"
#include "souple/rigid/impulse.h"
#include "souple/stages/rigid_stage.h"
#include "souple/stages/rigid_sums.h"
#include "souple/state/particles.h"

#include <algorithm>

// Velocities of rigid bodies that users and other stages read and change.

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

// --- as a part of AngularMomentum

bool RigidStage::is_free(std::uint32_t object) const {
  return bodies_.mass[index(object)].inverse > 0;
}

// As finish_bodies. A body is a point with a moment of inertia I = tr(S) - S, S = sum m r r^T.
void RigidStage::add_to(RigidSums& sums, std::uint32_t object, const Vec3d& origin, double h) const {
  const std::uint32_t body = index(object);
  const BodyPose& pose = bodies_.pose[body];
  const double m = records_[body].definition.mass;
  const Mat3d R = rotation_matrix(pose.rotation);
  const Vec3d& I = records_[body].definition.inertia;
  const Mat3d inertia = Mat3d{R.column[0] * I.x, R.column[1] * I.y, R.column[2] * I.z} * transpose(R);
  BodyVelocity v = bodies_.velocity[body];
  Vec3d spin = inertia * v.angular;
  if (h > 0) {
    const BodyPose& predicted = predicted_[body];
    v.linear += (pose.position - predicted.position) / h;
    const Vec3d turn = rotation_between(predicted.rotation, pose.rotation) / h;
    const Vec3d local = predicted.local_direction(v.angular + turn);
    spin = predicted.direction({local.x * I.x, local.y * I.y, local.z * I.z});
  }
  sums.add(m, pose.position - origin, v.linear);
  sums.angular += spin;
  const Mat3d S = Mat3d::identity() * (trace(inertia) / 2) - inertia;
  for (int row = 0, k = 0; row < 3; ++row)
    for (int column = 0; column <= row; ++column, ++k)
      sums.second[static_cast<std::size_t>(k)] += S.column[column][row];
}

Vec3d RigidStage::start_of(const ObjectsView& objects, std::uint32_t particle) const {
  const Object& object = *objects.objects[objects.object_of[particle]];
  if (!object.traits().rigid) return objects.view().exact_start(particle);
  const std::uint32_t body = index(object.id.value);
  const BodyPose& start = bodies_.start[body];
  return start.position + start.direction(records_[body].definition.particles[particle - object.begin]);
}

bool RigidStage::is_pushed(std::uint32_t object) const {
  const std::uint32_t body = index(object);
  const auto& contacts = finder_.contacts();
  return std::any_of(contacts.begin(), contacts.end(), [&](const RigidContact& contact) {
    return (contact.a == body || contact.b == body) && pushes(contact);
  });
}

}  // namespace souple
