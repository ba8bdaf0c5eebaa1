#include "souple/world/joints/joints.h"

#include "souple/math/elementary.h"
#include "souple/objects/collider_record.h"
#include "souple/objects/object.h"
#include "souple/queries/nearest_name.h"
#include "souple/rigid/joints/joint.h"
#include "souple/stages/rigid_joints.h"
#include "souple/stages/rigid_stage.h"
#include "souple/world/call_scope.h"
#include "souple/world/impl.h"
#include "souple/world/registry.h"
#include "souple/world/sleeping.h"
#include "souple/world/world.h"

#include <cmath>

#include <fmt/core.h>

namespace souple {
namespace {

std::size_t index_of(const WorldState& world, JointId id) {
  if (const std::optional<std::size_t> index = world.registry->joints.find(id.value)) return *index;
  throw_stale("joint", id.value);
}

/// Pose of a rigid body, of a collider at the world's time, or of the world.
BodyPose pose_of(const WorldState& world, const JointSide& side) {
  if (side.is_world()) return {};
  if (side.object()) return *world.rigid->pose(side.object()->value);
  const std::size_t index = *world.registry->colliders.find(side.collider()->value);
  const Transform pose = world.colliders[index].options.motion.at(world.time);
  return {pose.translation, pose.rotation};
}

void require_side(WorldState& world, const JointSide& side, const std::string& name) {
  if (side.collider()) world.collider(*side.collider());
  if (!side.object()) return;
  const Object& object = world.object(*side.object());
  if (!object.traits().rigid)
    throw Error(
        fmt::format("joint '{}': {} is a {}, expected a rigid_body; join vertices by connect or attach", name,
                    object.name, object.traits().name));
}

void require_sides(WorldState& world, const JointSide& a, const JointSide& b, const std::string& name) {
  require_side(world, a, name), require_side(world, b, name);
  if (!a.object() && !b.object()) throw Error(fmt::format("joint '{}': neither side is a rigid body", name));
  if (a == b) throw Error(fmt::format("joint '{}': joins a body to itself; name two different bodies", name));
}

/// The rotation whose first and third axes are those of the options.
Quatd axes_of(const JointOptions& options) {
  const Quatd first = joint::axes_along(options.axis);
  if (!options.second_axis || !(length_squared(options.axis) > 0)) return first;
  // The turn about the first axis by which the projection of the second option misses the third axis.
  const Vec3d z = rotate(first, {0, 0, 1}), y = rotate(first, {0, 1, 0});
  const double along_y = dot(*options.second_axis, y), along_z = dot(*options.second_axis, z);
  const double across = elementary::hypot(along_y, along_z);
  if (!(across > 1e-6 * length(*options.second_axis)))
    throw Error(fmt::format("joint '{}': second_axis is parallel to axis, or 0; expected a perpendicular one",
                            options.name));
  const double cosine = along_z / across, half = std::sqrt(std::max(0.0, (1 + cosine) / 2));
  const double sine = std::sqrt(std::max(0.0, (1 - cosine) / 2)) * (along_y > 0 ? -1 : 1);
  return normalized(first * Quatd{sine, 0, 0, half});
}

joint::Frame frame_in(const BodyPose& pose, const Vec3d& point, const Quatd& axes) {
  return {pose.local_point(point), conjugate(pose.rotation) * axes};
}

/// Throws Error unless the values are in their ranges. The joint's bodies are not known by index yet.
void validate_alone(joint::Joint joint, const JointSide& a, const JointSide& b) {
  joint.a = a.is_world() ? no_body : 0, joint.b = b.is_world() ? no_body : 1;
  joint::validate(joint, 2);
}

void wake_sides(WorldState& world, const JointRecord& record) {
  for (const JointSide* const side : {&record.a, &record.b})
    if (side->object()) wake_island(world, world.object(*side->object()));
}

void remove_joints(WorldState& world, std::span<const IndexRange> ranges) {
  RigidJoints& joints = world.rigid->joints();
  if (ranges.empty()) return;
  for (const IndexRange& range : ranges)
    for (std::size_t k = range.begin; k < range.end; ++k)
      world.registry->joint_names.remove(joints.joints().joint[k].name);
  joints.remove(ranges);
  const std::span<const JointRecord> records = joints.records();
  world.registry->joints.reset(records.size(), [&](std::size_t k) { return records[k].id.value; });
  world.rigid->invalidate();
}

}  // namespace

void remove_joints_if(WorldState& world, const std::function<bool(const JointSide&)>& holds) {
  const std::span<const JointRecord> records = world.rigid->joints().records();
  remove_joints(world, ranges_where(records.size(), [&](std::size_t k) {
                  return holds(records[k].a) || holds(records[k].b);
                }));
}

void report_joints(WorldState& world) {
  const RigidJoints& joints = world.rigid->joints();
  if (joints.empty()) return;
  world.report.broken_joints = joints.broken().size();
  for (const std::uint32_t j : joints.broken()) {
    const joint::JointState& state = joints.joints().state[j];
    world.warnings.log_info(joints.joints().joint[j].name,
                            {fmt::format("the joint broke at {:.4g} N and {:.4g} N m", length(state.force),
                                         length(state.torque))});
  }
}

JointId World::add_joint(const JointSide& a, const JointSide& b, const joint::Kind& kind,
                         const JointOptions& options) {
  WorldState& world = state();
  const CallScope call(*world.calls, "add_joint");
  NameRegistry& names = world.registry->joint_names;
  joint::Joint joint{.name = options.name, .kind = kind};
  if (joint.name.empty()) joint.name = names.first_free(joint::kind_name(kind));
  names.require_free(joint.name);
  require_sides(world, a, b, joint.name);
  const Quatd axes = axes_of(options);
  joint.frame_a = frame_in(pose_of(world, a), options.point, axes);
  joint.frame_b = frame_in(pose_of(world, b), options.point_b.value_or(options.point), axes);
  joint.breaking_force = options.breaking_force, joint.breaking_torque = options.breaking_torque;
  validate_alone(joint, a, b);
  const JointRecord record{{world.registry->next_id}, a, b, options.collide};
  const std::string name = joint.name;
  names.add(name, {NameRegistry::Owner::joint, record.id.value});
  try {
    world.registry->joints.add(record.id.value);
    world.rigid->joints().add(record, std::move(joint));
  } catch (...) {
    world.registry->joints.remove_last(record.id.value);
    names.remove(name);
    throw;
  }
  ++world.registry->next_id;
  world.rigid->invalidate();
  wake_sides(world, record);
  return record.id;
}

JointId World::add_joint(const JointSide& a, const JointSide& b, const joint::Kind& kind) {
  return add_joint(a, b, kind, {});
}

void World::remove(JointId id) {
  WorldState& world = state();
  const CallScope call(*world.calls, "remove(JointId)");
  const std::size_t index = index_of(world, id);
  wake_sides(world, world.rigid->joints().records()[index]);
  remove_joints(world, std::array{IndexRange{index, index + 1}});
}

void World::set_joint(JointId id, const joint::Kind& kind) {
  WorldState& world = state();
  const CallScope call(*world.calls, "set_joint", From::stages);
  const std::size_t index = index_of(world, id);
  const JointRecord& record = world.rigid->joints().records()[index];
  joint::Joint changed = world.rigid->joints().joints().joint[index];
  if (changed.kind.index() != kind.index())
    throw Error(fmt::format("set_joint: '{}' is a {} joint, got a {}; remove it and add another one",
                            changed.name, joint::kind_name(changed.kind), joint::kind_name(kind)));
  changed.kind = kind;
  validate_alone(changed, record.a, record.b);
  world.rigid->joints().set_kind(index, kind);
  wake_sides(world, record);
}

const joint::Kind& World::joint_kind(JointId id) const {
  const WorldState& world = state();
  return world.rigid->joints().joints().joint[index_of(world, id)].kind;
}

JointReport World::joint_report(JointId id) const {
  const WorldState& world = state();
  const QueryScope query(*world.calls, "joint_report");
  const RigidJoints& joints = world.rigid->joints();
  const std::size_t index = index_of(world, id);
  const JointRecord& record = joints.records()[index];
  const joint::Joint& joint = joints.joints().joint[index];
  const joint::JointState& now = joints.joints().state[index];
  const joint::Ends ends =
      joint::ends_of(joint, pose_of(world, record.a), pose_of(world, record.b), now.angle);
  const joint::JointError error = now.broken ? joint::JointError{} : error_of(joint, ends);
  return {joint.name,
          ends.point_a,
          ends.point_b,
          ends.axes_a.column[0],
          now.force,
          now.torque,
          joint::coordinates_of(joint, ends),
          error.distance,
          error.angle,
          now.broken};
}

std::vector<JointId> World::joints() const {
  std::vector<JointId> ids;
  for (const JointRecord& record : state().rigid->joints().records()) ids.push_back(record.id);
  return ids;
}

JointId World::find_joint(std::string_view name) const {
  const WorldState& world = state();
  if (const NameRegistry::Entry* const entry = world.registry->joint_names.find(name)) return {entry->id};
  std::vector<std::string_view> names;
  for (const joint::Joint& joint : world.rigid->joints().joints().joint) names.push_back(joint.name);
  throw Error("no joint is named '" + std::string(name) + "'" + nearest_name(name, names));
}

}  // namespace souple
