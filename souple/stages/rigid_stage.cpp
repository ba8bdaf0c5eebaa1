#include "souple/stages/rigid_stage.h"

#include "souple/assert.h"
#include "souple/contacts/collider.h"
#include "souple/contacts/contact_projector.h"
#include "souple/contacts/contacts.h"
#include "souple/objects/object.h"
#include "souple/objects/obstacle_pose.h"
#include "souple/rigid/free_motion.h"
#include "souple/stages/body_motion.h"
#include "souple/stages/rigid_joints.h"
#include "souple/stages/rigid_sums.h"
#include "souple/stages/saved_rigid_bodies.h"
#include "souple/stages/stage_view.h"
#include "souple/stages/ties.h"
#include "souple/state/bytes.h"
#include "souple/state/saved_bytes.h"

#include <algorithm>
#include <utility>

namespace souple {
namespace {

// The number of touched particles for which masses are split falls at most by this factor in a substep. Contacts that
// come and go then do not change the masses that other constraints see.
constexpr double decay_of_shown = 0.95;
// A body between obstacles that cannot give way keeps this part of its velocity in a substep. It moves on once the path
// is free. A force that presses on it gives it at most the speed of ten substeps of free fall.
constexpr double held_part = 0.9;
// Contacts and joints take turns, joints last. A crate on a bridge of planks sinks into it by 1.7 mm after one turn, 0.4 mm
// after two, 0.05 mm after four.
constexpr int rounds_with_joints = 4;
// Assumed number of touched particles at first contact: the corners of a box.
constexpr double least_shown = 8;

/// 0 without mass: of kinematic bodies.
float inverse_mass(float mass) {
  return mass > 0 ? 1 / mass : 0;
}

RigidShape shape_of(const Collider& collider) {
  if (const auto convex = convex_shape_of(collider.shape)) return {{*convex}, nullptr, nullptr};
  return {{}, &collider.shape, nullptr};
}

BodyPose pose_of(const Transform& transform) {
  return {transform.translation, transform.rotation};
}

// As for particles, contacts that approach more slowly than a fall of two substeps do not bounce.
RigidSubstep of_contacts(const StageView& stage, const Substep& substep) {
  constexpr double depenetration_speed = 1.5;  // of a fall by 11 cm [m/s]
  const auto h = static_cast<double>(substep.h);
  const Vec3d gravity(stage.settings.gravity);
  return {h, substep.iterations, depenetration_speed, 2 * length(gravity) * h, gravity};
}

}  // namespace

class RigidStage::Materials final : public RigidMaterials {
 public:
  explicit Materials(const RigidStage& stage) : stage_(stage) {}
  bool collide(std::uint32_t a, std::uint32_t b) const override {
    if (stage_.joints_->joined(a, b)) return false;
    if (stage_.is_collider(a)) std::swap(a, b);
    if (is_driven(a) && is_driven(b)) return false;
    if (!stage_.is_collider(b)) return may_collide(filter(a), filter(b)) && objects().collide(row(a), row(b));
    return stage_.tables_->colliders[row(b)].enabled &&
           stage_.tables_->against_colliders.collide(row(a), row(b));
  }
  ContactMaterialPair at(std::uint32_t a, std::uint32_t b) const override {
    return stage_.is_collider(b) ? stage_.tables_->against_colliders.at(row(a), row(b))
                                 : objects().at(row(a), row(b));
  }

 private:
  bool is_driven(std::uint32_t body) const {
    return body >= stage_.records_.size() || stage_.records_[body].drive;
  }
  std::size_t row(std::uint32_t body) const { return stage_.rows_[body]; }
  const CollisionFilter& filter(std::uint32_t body) const { return stage_.object_of(body).collision.filter; }
  const ContactMaterialTable& objects() const { return stage_.tables_->against_objects; }

  const RigidStage& stage_;
};

RigidStage::RigidStage() : joints_(std::make_unique<RigidJoints>()) {}
RigidStage::~RigidStage() = default;

// --- bodies by object

RigidStage::Record* RigidStage::find(std::uint32_t object) {
  const auto at = std::lower_bound(records_.begin(), records_.end(), object,
                                   [](const Record& record, std::uint32_t id) { return record.object < id; });
  return at != records_.end() && at->object == object ? &*at : nullptr;
}

const RigidStage::Record* RigidStage::find(std::uint32_t object) const {
  return const_cast<RigidStage*>(this)->find(object);  // NOLINT(cppcoreguidelines-pro-type-const-cast)
}

void RigidStage::add(std::uint32_t object, RigidDefinition definition) {
  SOUPLE_ASSERT(records_.empty() || records_.back().object < object, "ids ascend");
  Record record;
  record.object = object;
  record.pose = definition.pose;
  record.definition = std::move(definition);
  records_.push_back(std::move(record));
  invalidate();
}

void RigidStage::remove_if(const std::function<bool(std::uint32_t)>& is_removed) {
  if (std::erase_if(records_, [&](const Record& record) { return is_removed(record.object); }) == 0) return;
  finder_.clear();
  invalidate();
}

const RigidDefinition* RigidStage::definition(std::uint32_t object) const {
  const Record* const record = find(object);
  return record ? &record->definition : nullptr;
}

const BodyPose* RigidStage::pose(std::uint32_t object) const {
  const Record* const record = find(object);
  return record ? &record->pose : nullptr;
}

const BodyVelocity* RigidStage::velocity(std::uint32_t object) const {
  const Record* const record = find(object);
  return record ? &record->velocity : nullptr;
}

void RigidStage::place(std::uint32_t object, const BodyPose& pose) {
  Record* const record = find(object);
  if (!record) return;
  record->pose = pose;
  if (record->drive) record->drive->to = pose;
}

std::uint32_t RigidStage::index(std::uint32_t object) const {
  const Record* const record = find(object);
  return record ? static_cast<std::uint32_t>(record - records_.data()) : no_body;
}

void RigidStage::set_velocity(std::uint32_t object, const BodyVelocity& velocity) {
  if (Record* const record = find(object)) record->velocity = velocity;
}

// --- particles

bool RigidStage::is_awake(std::size_t body) const {
  return objects_[body]->sleep.island == 0;
}

template <class F>
void RigidStage::for_each_awake(const StageView& stage, F&& f) {
  constexpr std::size_t grain = 16;
  stage.threads.each(records_.size(), grain, [&](std::size_t k) {
    if (is_awake(k)) f(k);
  });
}

std::span<const Vec3d> RigidStage::arms(std::size_t body, const Quatd& rotation) {
  Record& record = records_[body];
  const std::vector<Vec3d>& local = record.definition.particles;
  const Quatd& at = record.arms_at;
  if (record.arms.size() == local.size() && at.x == rotation.x && at.y == rotation.y && at.z == rotation.z &&
      at.w == rotation.w)
    return record.arms;
  record.arms.resize(local.size());
  record.arms_at = rotation;
  const Mat3d R = rotation_matrix(rotation);
  for (std::size_t i = 0; i < local.size(); ++i) record.arms[i] = R * local[i];
  return record.arms;
}

void RigidStage::write_positions(const StageView& stage, std::size_t body, const BodyPose& pose) {
  const std::span<const Vec3d> r = arms(body, pose.rotation);
  const Vec4f* const position = stage.objects.particles.position.data() + objects_[body]->begin;
  Vec4f* const moving = stage.objects.particles.offset.data() + objects_[body]->begin;
  std::vector<Vec3f>& written = records_[body].written;
  written.resize(r.size());
  for (std::size_t i = 0; i < r.size(); ++i) {
    const Vec3d x = pose.position + r[i];
    written[i] = Vec3f(x - Vec3d(position[i].xyz()));
    moving[i].set_xyz(written[i]);
  }
}

void RigidStage::write_velocities(const StageView& stage, std::size_t body) {
  Vec4f* const velocity = stage.objects.particles.velocity.data() + objects_[body]->begin;
  const BodyVelocity v = bodies_.velocity[body];
  const std::span<const Vec3d> r = arms(body, bodies_.pose[body].rotation);
  for (std::size_t i = 0; i < r.size(); ++i) velocity[i].set_xyz(Vec3f(v.at(r[i])));
}

// Takes over the impulses that changed particles' velocities since the body wrote them.
void RigidStage::read_velocities(const StageView& stage, std::size_t body) {
  const Vec4f* const velocity = stage.objects.particles.velocity.data() + objects_[body]->begin;
  const Vec4f* const position = stage.objects.particles.position.data() + objects_[body]->begin;
  const BodyVelocity before = bodies_.velocity[body];
  Vec3d impulse, moment;
  const std::span<const Vec3d> r = arms(body, bodies_.pose[body].rotation);
  for (std::size_t i = 0; i < r.size(); ++i) {
    const Vec3f change = velocity[i].xyz() - Vec3f(before.at(r[i]));
    const auto w = static_cast<double>(position[i].w);
    if (!(w > 0) || change == Vec3f{}) continue;
    const Vec3d J = Vec3d(change) / w;
    impulse += J, moment += cross(r[i], J);
  }
  const auto b = static_cast<std::uint32_t>(body);
  push_velocity(bodies_, b, {}, impulse);
  turn_velocity(bodies_, b, moment);
}

// --- a step

void RigidStage::list_bodies(const StageView& stage, const ContactTables& tables) {
  objects_.clear(), rows_.clear(), colliders_.clear(), shapes_.clear();
  for (std::uint32_t row = 0; row < stage.objects.objects.size(); ++row)
    if (stage.objects.objects[row]->traits().rigid) {
      objects_.push_back(stage.objects.objects[row].get());
      rows_.push_back(row);
    }
  SOUPLE_ASSERT(objects_.size() == records_.size(), "each rigid body has a record");
  for (const Record& record : records_) shapes_.push_back(record.definition.shape);
  for (std::uint32_t column = 0; column < tables.colliders.size(); ++column) {
    colliders_.push_back(&tables.colliders[column]);
    rows_.push_back(column);
    shapes_.push_back(shape_of(tables.colliders[column]));
  }
  list_obstacles(stage);
  bodies_.resize(rows_.size());
  predicted_.resize(rows_.size());
  holding_.reset(records_.size());
  held_sets_.resize(records_.size());
  tables_ = &tables;
  joints_->list([this](const JointSide& side) { return body_of(side); });
  listed_ = true;
}

// The mesh of an obstacle is its rest positions, which its motion's pose places.
void RigidStage::list_obstacles(const StageView& stage) {
  const std::vector<std::uint32_t> last_ids = std::exchange(mesh_ids_, {});
  const std::vector<std::shared_ptr<const MeshShape>> last = std::exchange(meshes_, {});
  obstacles_.clear();
  for (std::uint32_t row = 0; row < stage.objects.objects.size(); ++row) {
    const Object& object = *stage.objects.objects[row];
    if (!object.traits().driven || deforms(object.motion)) continue;
    const auto known = std::find(last_ids.begin(), last_ids.end(), object.id.value);
    mesh_ids_.push_back(object.id.value);
    meshes_.push_back(known != last_ids.end()
                          ? last[static_cast<std::size_t>(known - last_ids.begin())]
                          : std::make_shared<const MeshShape>(object.rest, object.surface));
    obstacles_.push_back(&object);
    rows_.push_back(row);
    shapes_.push_back({{}, nullptr, meshes_.back()});
  }
  // Contacts name bodies by index.
  const std::size_t first = records_.size() + colliders_.size();
  const bool same = first == first_obstacle_ && last_ids.size() <= mesh_ids_.size() &&
                    std::equal(last_ids.begin(), last_ids.end(), mesh_ids_.begin());
  if (!last_ids.empty() && !same) finder_.clear();
  first_obstacle_ = first;
}

const Object& RigidStage::object_of(std::size_t body) const {
  return body < records_.size() ? *objects_[body] : *obstacles_[body - records_.size() - colliders_.size()];
}

const ColliderMotion& RigidStage::motion_of(std::size_t body) const {
  return is_collider(body) ? colliders_[body - records_.size()]->motion : object_of(body).motion.pose;
}

void RigidStage::set_colliders(std::vector<ColliderId> ids) {
  collider_ids_ = std::move(ids);
  invalidate();
}

std::uint32_t RigidStage::body_of(const JointSide& side) const {
  if (side.object()) return static_cast<std::uint32_t>(find(side.object()->value) - records_.data());
  const auto column = std::find(collider_ids_.begin(), collider_ids_.end(), *side.collider());
  SOUPLE_ASSERT(column != collider_ids_.end(), "joints of a removed collider are removed");
  return static_cast<std::uint32_t>(records_.size()) +
         static_cast<std::uint32_t>(column - collider_ids_.begin());
}

void RigidStage::begin_step(const StageView& stage, const ContactTables& tables, double dt) {
  if (empty()) return;
  if (!listed_) list_bodies(stage, tables);
  joints_->begin_step();
  for (std::size_t k = 0; k < records_.size(); ++k) {
    const Record& record = records_[k];
    bodies_.mass[k] = mass_of(k);
    bodies_.pose[k] = record.pose;
    bodies_.velocity[k] = is_awake(k) ? record.velocity : BodyVelocity{};
    bodies_.inverse_inertia[k] = world_inverse_inertia(bodies_.mass[k], record.pose.rotation);
    if (is_awake(k)) {
      read_velocities(stage, k);
      write_velocities(stage, k);
    } else {
      records_[k].velocity = {};
    }
  }
  for (std::size_t k = records_.size(); k < bodies_.size(); ++k) {
    const ColliderMotion& motion = motion_of(k);
    bodies_.mass[k] = {}, bodies_.inverse_inertia[k] = {}, bodies_.velocity[k] = {};
    stage.warnings.guarded(is_collider(k) ? "a collider's motion" : "an obstacle's motion", [&] {
      bodies_.pose[k] = pose_of(motion.at(stage.time));
      if (!motion.is_static() && !motion.jumps(stage.time, stage.time + dt))
        bodies_.velocity[k] = velocity_between(bodies_.pose[k], pose_of(motion.at(stage.time + dt)), dt);
    });
  }
  const double gravity = length(Vec3d(stage.settings.gravity));
  const double part = 1.0 / stage.settings.substeps;
  finder_.begin_step(bodies_, shapes_, Materials(*this), dt, part, gravity, stage.threads);
  solver_.prepare(finder_.contacts(), bodies_);
  fresh_ = true;
}

void RigidStage::place_colliders(const StageView& stage, const Substep& substep) {
  const auto h = static_cast<double>(substep.h);
  for (std::size_t k = records_.size(); k < bodies_.size(); ++k) {
    const ColliderMotion& motion = motion_of(k);
    if (motion.is_static()) continue;
    bodies_.velocity[k] = {};  // where its motion fails, it stands
    stage.warnings.guarded(is_collider(k) ? "a collider's motion" : "an obstacle's motion", [&] {
      const BodyPose after = pose_of(motion.at(stage.time + h));
      const BodyPose before =
          motion.jumps(stage.time, stage.time + h) ? after : pose_of(motion.at(stage.time));
      bodies_.pose[k] = before;
      bodies_.velocity[k] = velocity_between(before, after, h);
    });
  }
}

void RigidStage::predict(const StageView& stage, const Substep& substep) {
  if (empty()) return;
  const auto h = static_cast<double>(substep.h);
  const Vec3d g(stage.settings.gravity);
  place_colliders(stage, substep);
  place_kinematic(stage, substep);
  if (!fresh_) finder_.refresh(bodies_, shapes_, stage.threads);
  fresh_ = false;
  for_each_awake(stage, [&](std::size_t k) {
    // Gravity acts on the center of mass exactly. The center of the particles' masses may be elsewhere.
    bodies_.velocity[k].linear += g * h;
    read_velocities(stage, k);
    bodies_.velocity[k].linear -= g * h;
  });
  solver_.bounce(finder_.contacts(), bodies_, of_contacts(stage, substep));
  predict_bodies(bodies_, g, h, predicted_);
  end_kinematic(stage, substep);
  joints_->begin_substep(bodies_, h);
  for_each_awake(stage, [&](std::size_t k) {
    write_positions(stage, k, bodies_.pose[k]);
    write_velocities(stage, k);
  });
}

bool RigidStage::is_as_written(const StageView& stage, std::size_t body) const {
  const Vec4f* const moving = stage.objects.particles.offset.data() + objects_[body]->begin;
  const std::vector<Vec3f>& written = records_[body].written;
  for (std::size_t i = 0; i < written.size(); ++i)
    if (!(moving[i].xyz() == written[i])) return false;
  return true;
}

void RigidStage::gather_body(const StageView& stage, std::size_t body) {
  if (is_as_written(stage, body)) return;
  const ParticleView view = stage.objects.view();
  const Record& record = records_[body];
  // Impulses act on positions at the substep's start, as those on other particles do.
  const Mat3d R = rotation_matrix(bodies_.start[body].rotation);
  Vec3d impulse, moment;
  for (std::size_t n = 0; n < record.written.size(); ++n) {
    const std::size_t i = objects_[body]->begin + n;
    const Vec3f moved = view.moving[i].xyz() - record.written[n];
    const auto w = static_cast<double>(view.inverse_mass(static_cast<std::uint32_t>(i)));
    if (!(w > 0) || moved == Vec3f{}) continue;
    const Vec3d J = Vec3d(moved) / w;
    impulse += J, moment += cross(R * record.definition.particles[n], J);
  }
  if (length_squared(impulse) + length_squared(moment) == 0) return;
  push(bodies_, static_cast<std::uint32_t>(body), {}, impulse);
  turn(bodies_, static_cast<std::uint32_t>(body), moment);
  write_positions(stage, body, bodies_.pose[body]);
}

void RigidStage::gather(const StageView& stage) {
  for_each_awake(stage, [&](std::size_t k) { gather_body(stage, k); });
}

void RigidStage::split_masses(const StageView& stage) {
  split_masses(stage, [](const Record& record) { return max(record.shown, least_shown); });
}

template <class Count>
void RigidStage::split_masses(const StageView& stage, const Count& count_of) {
  for_each_awake(stage, [&](std::size_t k) {
    if (records_[k].drive) return;
    const Vec3d& inverse_inertia = bodies_.mass[k].inverse_inertia;
    const double turning = max(inverse_inertia.x, max(inverse_inertia.y, inverse_inertia.z));
    const double count = count_of(records_[k]);
    std::size_t i = objects_[k]->begin;
    for (const Vec3d& local : records_[k].definition.particles) {
      // An upper bound of 1/m + (r x n)^T I^-1 (r x n) over all directions n.
      const double w = bodies_.mass[k].inverse + length_squared(local) * turning;
      stage.objects.particles.position[i++].w = static_cast<float>(w * count);
    }
  });
}

bool RigidStage::count_touched(const StageView& stage, std::span<Projector* const> contacts) {
  for (Record& record : records_) record.touched = 0;
  touched_at_.resize(stage.objects.particles.size());
  ++counts_;
  const auto touch = [&](std::uint32_t particle) {
    const Object& object = *stage.objects.objects[stage.objects.object_of[particle]];
    if (!object.traits().rigid || touched_at_[particle] == counts_) return;
    touched_at_[particle] = counts_;
    ++find(object.id.value)->touched;
  };
  for (Projector* const projector : contacts)
    if (projector->facets().contact != nullptr)
      projector->visit(stage.objects.view(), [&](const ConstraintState& state) {
        for (const std::uint32_t i : state.particles) touch(i);
      });
  bool more = false;
  for (Record& record : records_) {
    if (!(record.touched > max(record.shown, least_shown))) continue;
    record.shown = record.touched;
    more = true;
  }
  if (more) split_masses(stage);
  return more;
}

void RigidStage::begin_ties(const StageView& stage, const Substep& substep, Ties& ties) {
  if (ties.empty()) return;
  if (ties.holds_bodies()) gather(stage);
  ties.begin(stage.objects.view(), bodies_, stage.objects.particles.position, substep);
  if (ties.holds_bodies())
    for_each_awake(stage, [&](std::size_t k) { write_positions(stage, k, bodies_.pose[k]); });
}

// A body has felt an n-th of each contact, n being the assumed number of touched particles. In these rounds it is that of
// the particles that are pushed. Otherwise after_solve would move soft objects out of the way of bodies that are
// lighter.
void RigidStage::repeat_contacts(const StageView& stage, Contacts& contacts) {
  constexpr int rounds = 4;
  for (int round = 0; round < rounds; ++round) {
    for (Record& record : records_) record.chosen = 0;
    ++counts_;
    bool any = false;
    const auto count = [&](std::uint32_t particle) {
      if (std::exchange(touched_at_[particle], counts_) == counts_) return;
      ++find(stage.objects.objects[stage.objects.object_of[particle]]->id.value)->chosen;
      any = true;
    };
    contacts.choose_body_contacts(stage.objects.view(), std::ref(count));
    if (!any) return;
    split_masses(stage, [](const Record& record) { return max<double>(record.chosen, 1); });
    contacts.update_masses(stage.objects.view());
    contacts.project_body_contacts(stage.objects.view());
    gather(stage);
  }
}

// The two sides of a contact begin the substep apart: by its gap, and by what they then slip. So equal and opposite
// impulses have a moment, which the body takes back. Otherwise impacts change angular momentum by several percent.
void RigidStage::sum_moments(const StageView& stage, const Contacts& contacts) {
  for (Record& record : records_) record.moment = {};
  const ObjectsView& objects = stage.objects;
  contacts.visit_body_impulses([&](const ContactImpulse& contact) {
    Record* of_body = nullptr;
    for (std::size_t k = 0; k < contact.count; ++k) {
      const std::uint32_t i = contact.particle[k];
      if (!(objects.particles.position[i].w > 0)) return;  // it is held
      const Object& object = *objects.objects[objects.object_of[i]];
      if (object.traits().rigid) of_body = find(object.id.value);
    }
    if (of_body) of_body->moment += moment_of(objects, contact);
  });
}

Vec3d RigidStage::moment_of(const ObjectsView& objects, const ContactImpulse& contact) const {
  const std::uint32_t first = contact.particle[0];
  const Vec3d origin = start_of(objects, first);
  Vec3d sum;
  if (!(contact.moment == Vec3f{}))
    sum = Vec3d(contact.moment) * static_cast<double>(objects.particles.radius[first]);
  for (std::size_t k = 1; k < contact.count; ++k)
    sum += cross(start_of(objects, contact.particle[k]) - origin, Vec3d(contact.impulse[k]));
  return sum;
}

void RigidStage::solve(const StageView& stage, const Substep& substep, Contacts& contacts, Ties& ties) {
  if (!empty()) {
    h_ = static_cast<double>(substep.h);
    gather(stage);
    for (Record& record : records_)
      record.shown = max(static_cast<double>(record.touched), record.shown * decay_of_shown);
  }
  if (!ties.empty()) ties.end(stage.objects.view(), bodies_, stage.objects.particles.position);
  if (!empty()) {
    repeat_contacts(stage, contacts);
    sum_moments(stage, contacts);
  }
  solve_bodies(stage, substep, ties);
  if (!ties.empty()) ties.end_substep(stage.objects.view(), bodies_);
  for_each_awake(stage, [&](std::size_t k) {
    write_positions(stage, k, bodies_.pose[k]);
    for (std::uint32_t i = objects_[k]->begin; i < objects_[k]->end; ++i)
      stage.objects.particles.position[i].w = 0;
  });
}

void RigidStage::find_in_turns(const Ties& ties) {
  in_turns_.assign(bodies_.size(), 0);
  for (const joint::Joint& joint : joints_->joints().joint)
    for (const std::uint32_t body : {joint.a, joint.b})
      if (body < bodies_.size()) in_turns_[body] = 1;
  ties.for_each_body([this](std::uint32_t body) { in_turns_[body] = 1; });
}

void RigidStage::solve_bodies(const StageView& stage, const Substep& substep, Ties& ties) {
  const auto tie = [&](bool in_turns_only) {
    if (!ties.empty()) ties.project_all(stage.objects.view(), bodies_, in_turns_only);
  };
  if (empty()) return tie(false);
  const RigidSubstep of_substep = of_contacts(stage, substep);
  joints_->project(bodies_);
  solver_.solve(finder_.contacts(), bodies_, of_substep, stage.threads);
  joints_->project(bodies_);
  tie(false);
  if (!joints_->empty() || ties.holds_bodies()) {
    find_in_turns(ties);
    for (int round = 1; round < rounds_with_joints; ++round) {
      solver_.solve(finder_.contacts(), bodies_, of_substep, stage.threads, in_turns_);
      joints_->project(bodies_);
      tie(true);
    }
  }
  if (joints_->end_substep()) invalidate();  // bodies that were joined may collide now
}

// Whether obstacles on opposite sides stop the body. Where an object between two driven ones cannot give way,
// keep_apart returns all their particles to the start of the substep.
bool RigidStage::is_held(const StageView& stage, std::size_t body) const {
  constexpr double rounding = 1e-6;  // of positions
  const BodyPose &from = bodies_.start[body], &to = bodies_.pose[body];
  const Mat3d R_from = rotation_matrix(from.rotation), R_to = rotation_matrix(to.rotation);
  std::size_t i = objects_[body]->begin;
  bool moves = false;
  for (const Vec3d& local : records_[body].definition.particles) {
    const Vec3d start = from.position + R_from * local;
    const double way = length(to.position + R_to * local - start);
    const Vec3d x = stage.objects.particles.exact_position(i++);
    if (way <= rounding * (1 + length(start))) continue;
    if (length(x - start) > way / 2) return false;
    moves = true;
  }
  return moves;
}

// The pushes moved particles as if bodies were immovable. Their velocities keep a part s of what that gives, and the
// body receives the opposite impulse. A plastic impact leaves the least kinetic energy. With u = moved / h, J = sum m u,
// T = sum (x - x_body) x m u, and the velocities v, V, w without pushes, it has
//
//   s = (V . J + w . T - sum m v . u) / (sum m u^2 + J^2 / M + T . I^-1 T)
void RigidStage::share_pushes(const StageView& stage, std::size_t body, double inverse_h,
                              std::span<const BodyPush> pushes) {
  Particles& particles = stage.objects.particles;
  const auto b = static_cast<std::uint32_t>(body);
  Vec3d impulse, moment, shifted;
  double along = 0, size = 0;
  for (const BodyPush& push : pushes) {
    const auto m = static_cast<double>(particles.mass[push.particle]);
    const Vec3d u = Vec3d(push.moved) * inverse_h;
    const Vec3d v(particles.velocity[push.particle].xyz());
    impulse += u * m;
    moment += cross(particles.exact_position(push.particle) - bodies_.pose[body].position, u * m);
    shifted += cross(Vec3d(push.moved), v * m);
    along -= m * dot(u, v);
    size += m * length_squared(u);
  }
  bodies_.inverse_inertia[body] = world_inverse_inertia(bodies_.mass[body], bodies_.pose[body].rotation);
  turn_velocity(bodies_, b, -shifted);
  const BodyVelocity& v = bodies_.velocity[body];
  along += dot(v.linear, impulse) + dot(v.angular, moment);
  size += length_squared(impulse) * bodies_.mass[body].inverse +
          dot(moment, bodies_.inverse_inertia[body] * moment);
  if (!(along > 0)) return;
  const double part = min(1.0, along / size);
  for (const BodyPush& push : pushes) {
    Vec4f& velocity = particles.velocity[push.particle];
    velocity.set_xyz(velocity.xyz() + push.moved * static_cast<float>(part * inverse_h));
  }
  push_velocity(bodies_, b, {}, impulse * -part);
  turn_velocity(bodies_, b, moment * -part);
}

void RigidStage::take_pushes(const StageView& stage, const Substep& substep,
                             std::span<const BodyPush> pushes) {
  const double inverse_h = 1 / static_cast<double>(substep.h);
  const auto for_each_body = [&](const auto& f) {
    for (std::size_t begin = 0, end = 0; begin < pushes.size(); begin = end) {
      while (end < pushes.size() && pushes[end].object == pushes[begin].object) ++end;
      const std::uint32_t body = index(stage.objects.objects[pushes[begin].object]->id.value);
      if (bodies_.mass[body].inverse > 0) f(body, pushes.subspan(begin, end - begin));
    }
  };
  for_each_body([&](std::size_t, std::span<const BodyPush> of_body) {
    for (const BodyPush& push : of_body) {
      Vec4f& velocity = stage.objects.particles.velocity[push.particle];
      velocity.set_xyz(velocity.xyz() - push.moved * static_cast<float>(inverse_h));
    }
  });
  for_each_body([&](std::size_t body, std::span<const BodyPush> of_body) {
    share_pushes(stage, body, inverse_h, of_body);
  });
}

// A body that is held keeps a part of its velocity. Bodies that nothing immovable holds keep their common motion: what is
// between them, and gives way too slowly, must not take their momentum.
void RigidStage::hold(const StageView& stage, std::span<const Pinch> pinches) {
  for (Record& record : records_) record.held = false;
  for_each_awake(stage, [&](std::size_t k) { records_[k].held = is_held(stage, k); });
  if (std::none_of(records_.begin(), records_.end(), [](const Record& record) { return record.held; }))
    return;
  const auto body_at = [&](std::uint32_t row) { return index(stage.objects.objects[row]->id.value); };
  const auto is_free = [&](std::uint32_t row) {
    return stage.objects.objects[row]->traits().rigid && bodies_.mass[body_at(row)].inverse > 0;
  };
  holding_.reset(records_.size());
  for (const Pinch& pinch : pinches)
    if (is_free(pinch.body) && is_free(pinch.other)) holding_.join(body_at(pinch.body), body_at(pinch.other));
  held_sets_.assign(records_.size(), {});
  for (const Pinch& pinch : pinches)
    for (const std::uint32_t row : {pinch.body, pinch.other})
      if (is_free(row) && (!is_free(pinch.body) || !is_free(pinch.other)))
        held_sets_[holding_.root(body_at(row))].alone = false;
  const auto for_each_free = [&](const auto& f) {
    for (std::uint32_t k = 0; k < records_.size(); ++k)
      if (bodies_.mass[k].inverse > 0) f(k, held_sets_[holding_.root(k)]);
  };
  for_each_free([&](std::uint32_t k, HeldSet& set) {
    if (records_[k].held) bodies_.pose[k] = bodies_.start[k];
    if (set.bodies++ == 0) set.origin = bodies_.pose[k].position;
    set.any_held = set.any_held || records_[k].held;
    add_to(set.sums, records_[k].object, set.origin, 0);
  });
  for_each_free([&](std::uint32_t k, const HeldSet& set) {
    if (!set.any_held || !(set.alone ? set.bodies > 1 : records_[k].held)) return;
    BodyVelocity common;
    if (set.alone) {
      const RigidSums& sums = set.sums;
      const Vec3d center = sums.position / sums.mass;
      common.angular = spin_of(sums.inertia(), sums.angular - cross(center, sums.momentum));
      common.linear =
          sums.momentum / sums.mass + cross(common.angular, bodies_.pose[k].position - set.origin - center);
    }
    BodyVelocity& v = bodies_.velocity[k];
    v.linear = common.linear + (v.linear - common.linear) * held_part;
    v.angular = common.angular + (v.angular - common.angular) * held_part;
  });
}

void RigidStage::finish(const StageView& stage, const Substep& substep, const Contacts& contacts) {
  if (empty()) return;
  finish_bodies(bodies_, predicted_, static_cast<double>(substep.h));
  Particles& particles = stage.objects.particles;
  hold(stage, contacts.pinches());
  take_pushes(stage, substep, contacts.body_pushes());
  for_each_awake(stage, [&](std::size_t k) {
    if (length_squared(records_[k].moment) > 0) {
      bodies_.inverse_inertia[k] = world_inverse_inertia(bodies_.mass[k], bodies_.pose[k].rotation);
      turn_velocity(bodies_, static_cast<std::uint32_t>(k),
                    records_[k].moment * (-1 / static_cast<double>(substep.h)));
    }
    write_velocities(stage, k);
    for (std::uint32_t i = objects_[k]->begin; i < objects_[k]->end; ++i)
      particles.position[i].w = inverse_mass(particles.mass[i]);
    records_[k].pose = bodies_.pose[k], records_[k].velocity = bodies_.velocity[k];
  });
}

// Restitution of particles changes the velocities of touched bodies in this substep.
void RigidStage::gather_velocities(const StageView& stage) {
  for_each_awake(stage, [&](std::size_t k) {
    if (records_[k].touched > 0) {
      read_velocities(stage, k);
      write_velocities(stage, k);
      records_[k].velocity = bodies_.velocity[k];
    }
    for (std::uint32_t i = objects_[k]->begin; i < objects_[k]->end; ++i)
      stage.objects.particles.position[i].w = inverse_mass(stage.objects.particles.mass[i]);
  });
}

void RigidStage::keep() {
  for (Record& record : records_) record.kept_pose = record.pose, record.kept_velocity = record.velocity;
  joints_->keep();
}

void RigidStage::undo() {
  for (Record& record : records_) record.pose = record.kept_pose, record.velocity = record.kept_velocity;
  joints_->undo();
  finder_.clear();
  invalidate();
}

double RigidStage::deepest() const {
  return ContactSolver::deepest(finder_.contacts(), bodies_);
}

// --- state

void RigidStage::save(SavedBytesWriter& out) const {
  for (const Record& record : records_)
    out.put(SavedRigidBodies::Body{record.pose, record.velocity, record.shown});
  joints_->save(out);
  finder_.save(out);
}

SavedRigidBodies RigidStage::read(SavedBytes& in) const {
  SavedRigidBodies saved;
  saved.bodies = in.get_list<SavedRigidBodies::Body>(records_.size());
  for (const SavedRigidBodies::Body& body : saved.bodies)
    in.require(all_finite(body.pose.position) && is_rotation(body.pose.rotation) &&
               all_finite(body.velocity.linear) && all_finite(body.velocity.angular) &&
               all_finite(body.shown) && body.shown >= 0);
  saved.joints = joints_->read(in);
  saved.contacts = ContactFinder::read(in, records_.size());
  in.require_end();
  return saved;
}

void RigidStage::set(SavedRigidBodies saved) {
  for (std::size_t k = 0; k < records_.size(); ++k) {
    records_[k].pose = saved.bodies[k].pose;
    records_[k].velocity = saved.bodies[k].velocity;
    records_[k].shown = saved.bodies[k].shown;
  }
  joints_->set(std::move(saved.joints));
  finder_.set(std::move(saved.contacts));
  invalidate();
}

std::size_t RigidStage::bytes() const {
  std::size_t result = bytes_of(records_, rows_, shapes_, predicted_, touched_at_, held_sets_) +
                       holding_.bytes() + finder_.bytes() + solver_.bytes() + joints_->bytes();
  for (const auto& mesh : meshes_) result += mesh->bytes();
  for (const Record& record : records_)
    result += bytes_of(record.definition.particles, record.arms, record.written);
  return result;
}

}  // namespace souple
