#include "souple/world/rigid_bodies.h"

#include "souple/objects/checks.h"
#include "souple/objects/object.h"
#include "souple/objects/obstacle_pose.h"
#include "souple/objects/rigid_definition.h"
#include "souple/stages/rigid_stage.h"
#include "souple/world/call_scope.h"
#include "souple/world/contact_state.h"
#include "souple/world/impl.h"
#include "souple/world/sleeping.h"
#include "souple/world/world.h"

#include <utility>

#include <fmt/core.h>

// Functions of users on rigid bodies.

namespace souple {
namespace {

const RigidDefinition& definition_of(const WorldState& world, const Object& object, const char* what) {
  if (const RigidDefinition* const body = world.rigid->definition(object.id.value)) return *body;
  throw Error(fmt::format("{}: {} is a {}, expected a rigid_body", what, object.name, object.traits().name));
}

/// Kinematic bodies have no mass; their particles neither.
void set_masses(WorldState& world, const Object& object, double mass) {
  for (std::uint32_t i = object.begin; i < object.end; ++i) {
    world.particles.mass[i] = static_cast<float>(mass / object.particle_count());
    world.particles.position[i].w = mass > 0 ? 1 / world.particles.mass[i] : 0;
  }
}

void make_kinematic(WorldState& world, Object& object, bool kinematic) {
  if (object.motion.kinematic == kinematic) return;
  const double mass = definition_of(world, object, "set_kinematic").mass;
  wake_island(world, object);
  world.rigid->set_kinematic(object.id.value, kinematic);
  object.motion = {};
  object.motion.kinematic = kinematic;
  set_masses(world, object, kinematic ? 0 : mass);
  if (kinematic) {
    world.rigid->set_velocity(object.id.value, {});
    for (std::uint32_t i = object.begin; i < object.end; ++i) world.particles.velocity[i] = {};
  }
  world.dirty.masses = world.dirty.tables = true;
  world.contact->invalidate();
  ++world.version;
}

/// Moves the particles where a pose of the body has them.
void place_particles(WorldState& world, const Object& object, const BodyPose& pose) {
  const RigidDefinition& body = *world.rigid->definition(object.id.value);
  for (std::uint32_t k = 0; k < object.particle_count(); ++k) {
    world.teleport_particle(object.begin + k, pose.point(body.particles[k]));
    world.particles.velocity[object.begin + k] = {};
  }
}

}  // namespace

void require_dynamic(const Object& object, const char* what) {
  if (object.motion.kinematic)
    throw Error(
        fmt::format("{}: {} is kinematic, so nothing pushes it; use move_body or set_motion, or "
                    "set_kinematic(body, false) first",
                    what, object.name));
}

void require_no_motion(const Object& object, const char* what) {
  if (object.motion.kinematic && !is_static(object.motion))
    throw Error(fmt::format("{}: {} follows its motion; use set_motion", what, object.name));
}

void set_body_motion(WorldState& world, Object& object, ObstacleMotion motion) {
  if (!motion.sequence.frames.empty())
    throw Error("set_motion: " + object.name +
                " is a rigid body, which does not deform: leave the sequence empty");
  validate(motion, object.vertex_count(), object.name);
  motion.pose.at(world.time);  // throws what a callback throws, before anything changes
  make_kinematic(world, object, true);
  world.rigid->set_path(object.id.value, motion.pose);
  static_cast<ObstacleMotion&>(object.motion) = std::move(motion);
  const BodyPose now = world.rigid->path_pose(object.id.value, world.time);
  world.rigid->place(object.id.value, now);
  world.rigid->set_velocity(object.id.value, {});
  place_particles(world, object, now);
  wake_all(world);
  world.contact->invalidate();
  ++world.version;
}

void teleport_body(WorldState& world, const Object& object, const Transform& transform) {
  RigidStage& bodies = *world.rigid;
  const std::uint32_t id = object.id.value;
  const BodyPose pose = *bodies.pose(id);
  const BodyVelocity velocity = *bodies.velocity(id);
  bodies.place(id, {transform.point(pose.position), normalized(transform.rotation * pose.rotation)});
  bodies.set_velocity(id, {transform.direction(velocity.linear), transform.direction(velocity.angular)});
}

double kinetic_energy_of_body(const WorldState& world, const Object& object) {
  if (object.motion.kinematic) return 0;
  const RigidDefinition& body = *world.rigid->definition(object.id.value);
  const BodyVelocity v = world.rigid->velocity_now(world.particles, object);
  const Vec3d w = world.rigid->pose(object.id.value)->local_direction(v.angular);
  return 0.5 * body.mass * length_squared(v.linear) +
         0.5 * (body.inertia.x * w.x * w.x + body.inertia.y * w.y * w.y + body.inertia.z * w.z * w.z);
}

double potential_energy_of_body(const WorldState& world, const Object& object) {
  if (object.motion.kinematic) return 0;
  return -world.rigid->definition(object.id.value)->mass *
         dot(Vec3d(world.settings.gravity), world.rigid->pose(object.id.value)->position);
}

Vec3d momentum_of_body(const WorldState& world, const Object& object) {
  if (object.motion.kinematic) return {};
  return world.rigid->velocity_now(world.particles, object).linear *
         world.rigid->definition(object.id.value)->mass;
}

RigidBodyState World::rigid_body(ObjectId id) const {
  const WorldState& world = state();
  const Object& object = world.object(id);
  const RigidDefinition& body = definition_of(world, object, "rigid_body");
  const BodyPose& pose = *world.rigid->pose(id.value);
  const BodyVelocity velocity = world.rigid->velocity_now(world.particles, object);
  return {{pose.position, pose.rotation, 1},
          velocity.linear,
          velocity.angular,
          body.mass,
          body.inertia,
          object.motion.kinematic};
}

void World::set_kinematic(ObjectId id, bool kinematic) {
  WorldState& world = state();
  const CallScope call(*world.calls, "set_kinematic");
  Object& object = world.object(id);
  definition_of(world, object, "set_kinematic");
  make_kinematic(world, object, kinematic);
}

bool World::is_kinematic(ObjectId id) const {
  return state().object(id).motion.kinematic;
}

void World::move_body(ObjectId id, const Transform& pose) {
  WorldState& world = state();
  const CallScope call(*world.calls, "move_body");
  Object& object = world.object(id);
  definition_of(world, object, "move_body");
  if (!object.motion.kinematic)
    throw Error("move_body: " + object.name + " is not kinematic; call set_kinematic(body, true) first");
  validate(pose, object.name);
  static_cast<ObstacleMotion&>(object.motion) = {};
  world.rigid->move(id.value, {pose.translation, normalized(pose.rotation)});
}

void World::apply_impulse(ObjectId id, const Vec3f& impulse, const Vec3f& point) {
  WorldState& world = state();
  const CallScope call(*world.calls, "apply_impulse", From::stages);
  const Object& object = world.object(id);
  definition_of(world, object, "apply_impulse");
  require_dynamic(object, "apply_impulse");
  require_finite(object.name, "the impulse", impulse);
  require_within(object.name, "the point of an impulse", Vec3d(point), range::coordinate);
  wake_island(world, object);
  world.rigid->apply_impulse(world.particles, object, Vec3d(point), Vec3d(impulse), {});
  ++world.version;
}

void World::apply_angular_impulse(ObjectId id, const Vec3f& impulse) {
  WorldState& world = state();
  const CallScope call(*world.calls, "apply_angular_impulse", From::stages);
  const Object& object = world.object(id);
  definition_of(world, object, "apply_angular_impulse");
  require_dynamic(object, "apply_angular_impulse");
  require_finite(object.name, "the angular impulse", impulse);
  wake_island(world, object);
  world.rigid->apply_impulse(world.particles, object, {}, {}, Vec3d(impulse));
  ++world.version;
}

void World::set_body_velocity(ObjectId id, const Vec3f& velocity, const Vec3f& angular_velocity) {
  WorldState& world = state();
  const CallScope call(*world.calls, "set_body_velocity", From::stages);
  const Object& object = world.object(id);
  definition_of(world, object, "set_body_velocity");
  require_dynamic(object, "set_body_velocity");
  require_within(object.name, "the velocity", Vec3d(velocity), range::speed);
  require_within(object.name, "the angular velocity", Vec3d(angular_velocity), range::speed);
  wake_island(world, object);
  const BodyVelocity now = world.rigid->velocity_now(world.particles, object);
  world.rigid->change_velocity(world.particles, object,
                               {Vec3d(velocity) - now.linear, Vec3d(angular_velocity) - now.angular});
  ++world.version;
}

}  // namespace souple
