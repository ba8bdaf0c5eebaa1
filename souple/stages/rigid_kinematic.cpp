#include "souple/objects/object.h"
#include "souple/stages/body_motion.h"
#include "souple/stages/rigid_stage.h"
#include "souple/stages/stage_view.h"

#include <algorithm>
#include <utility>

// Kinematic rigid bodies: prescribed motion moves them, and no force pushes them. Their mass counts as infinite, and
// the inverse masses of their particles are 0.

namespace souple {
namespace {

Transform transform_of(const BodyPose& pose) {
  return {pose.position, pose.rotation, 1};
}

}  // namespace

bool RigidStage::is_kinematic(std::uint32_t object) const {
  const Record* const record = find(object);
  return record && record->drive;
}

void RigidStage::set_kinematic(std::uint32_t object, bool kinematic) {
  Record* const record = find(object);
  if (!record || record->drive.has_value() == kinematic) return;
  record->drive.reset();
  if (kinematic) record->drive = Drive{nullptr, record->pose, record->pose, 0, 0};
}

void RigidStage::set_path(std::uint32_t object, ColliderMotion path) {
  set_kinematic(object, true);
  if (Record* const record = find(object))
    record->drive->path = std::make_shared<const ColliderMotion>(std::move(path));
}

void RigidStage::move(std::uint32_t object, const BodyPose& pose) {
  Record* const record = find(object);
  if (!record || !record->drive) return;
  record->drive->path.reset();
  record->drive->to = pose;
}

BodyPose RigidStage::pose_at(const Record& record, double time) {
  const Drive& drive = *record.drive;
  if (drive.path) {
    const Transform moved = drive.path->at(time);
    const BodyPose& added = record.definition.pose;
    return {moved.point(added.position), normalized(moved.rotation * added.rotation)};
  }
  if (!(drive.length > 0)) return record.pose;
  constexpr double rounding = 1e-9;  // of the last substep's end
  double part = std::clamp((time - drive.start) / drive.length, 0.0, 1.0);
  if (part > 1 - rounding) part = 1;
  const Transform between = interpolate(transform_of(drive.from), transform_of(drive.to), part);
  return {between.translation, between.rotation};
}

BodyPose RigidStage::path_pose(std::uint32_t object, double time) const {
  const Record& record = *find(object);
  return record.drive && record.drive->path ? pose_at(record, time) : record.pose;
}

BodyMass RigidStage::mass_of(std::size_t body) const {
  const Record& record = records_[body];
  if (!is_awake(body) || record.drive) return {};
  const Vec3d& I = record.definition.inertia;
  return {1 / record.definition.mass, {1 / I.x, 1 / I.y, 1 / I.z}};
}

void RigidStage::aim(const StageView& stage, double dt) {
  for (const auto& object : stage.objects.objects) {
    Record* const record = object->traits().rigid ? find(object->id.value) : nullptr;
    if (!record || !record->drive) continue;
    Drive& drive = *record->drive;
    drive.from = record->pose, drive.start = stage.time, drive.length = dt;
    record->velocity = {};  // where its motion fails, it stands
    stage.warnings.guarded("a rigid body's motion", [&] {
      if (!drive.path || !drive.path->jumps(stage.time, stage.time + dt))
        record->velocity = velocity_between(record->pose, pose_at(*record, stage.time + dt), dt);
    });
    const Mat3d R = rotation_matrix(record->pose.rotation);
    std::size_t i = object->begin;
    for (const Vec3d& local : record->definition.particles)
      stage.objects.particles.velocity[i++].set_xyz(Vec3f(record->velocity.at(R * local)));
  }
}

// Before the prediction of a substep: a body that was held catches up with its path.
void RigidStage::place_kinematic(const StageView& stage, const Substep& substep) {
  const auto h = static_cast<double>(substep.h);
  for (std::size_t k = 0; k < records_.size(); ++k) {
    const Record& record = records_[k];
    if (!record.drive) continue;
    bodies_.velocity[k] = {};
    stage.warnings.guarded("a rigid body's motion", [&] {
      const BodyPose after = pose_at(record, stage.time + h);
      if (record.drive->path && record.drive->path->jumps(stage.time, stage.time + h))
        bodies_.pose[k] = after;
      bodies_.velocity[k] = velocity_between(bodies_.pose[k], after, h);
    });
  }
}

// After the prediction: exactly on the path.
void RigidStage::end_kinematic(const StageView& stage, const Substep& substep) {
  const double t = stage.time + static_cast<double>(substep.h);
  for (std::size_t k = 0; k < records_.size(); ++k) {
    if (!records_[k].drive) continue;
    BodyPose pose = predicted_[k];
    stage.warnings.guarded("a rigid body's motion", [&] { pose = pose_at(records_[k], t); });
    bodies_.pose[k] = predicted_[k] = pose;
    if (!(bodies_.velocity[k].linear == Vec3d{}) || !(bodies_.velocity[k].angular == Vec3d{})) continue;
    // The body stands or has jumped, so it did not move there.
    write_positions(stage, k, bodies_.pose[k]);
    for (std::uint32_t i = objects_[k]->begin; i < objects_[k]->end; ++i)
      stage.objects.particles.start[i].set_xyz(stage.objects.particles.offset[i].xyz());
  }
}

}  // namespace souple
