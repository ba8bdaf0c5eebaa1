#pragma once

#include "souple/collision/collider_motion.h"
#include "souple/math/disjoint_sets.h"
#include "souple/objects/handles.h"
#include "souple/objects/rigid_definition.h"
#include "souple/rigid/contact_finder.h"
#include "souple/rigid/contact_solver.h"
#include "souple/stages/rigid_sums.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace souple {

struct BodyPush;
struct Collider;
struct ContactImpulse;
struct ContactPush;
struct ContactTables;
struct Object;
struct ObjectsView;
struct Particles;
struct Pinch;
class Projector;
class Contacts;
class RigidJoints;
class SavedBytes;
class SavedBytesWriter;
struct SavedRigidBodies;
class JointSide;
struct StageView;
struct Substep;
class Ties;

/// The rigid bodies of a world in its step. Their particles are points of their surfaces: the body moves its particles,
/// and pushes on the particles push the body. A push on one particle deforms the body; each call here makes it rigid
/// again.
///
/// The impulse J on a particle is its mass times its change of velocity, or times its change of position over h.
/// Impulses are exact, whatever mass the particle shows to others. While contacts are solved, this mass is a part of
/// the body's. If n particles of a body are touched, each shows an n-th. This is mass splitting: Tonge et al. 2012,
/// "Mass splitting for jitter-free parallel rigid body simulation". So all together push the body no farther than each
/// of them was pushed.
class RigidStage {
 public:
  RigidStage();
  ~RigidStage();
  RigidStage(const RigidStage&) = delete;
  RigidStage& operator=(const RigidStage&) = delete;

  bool empty() const { return records_.empty(); }
  void add(std::uint32_t object, RigidDefinition definition);
  void remove_if(const std::function<bool(std::uint32_t object)>& is_removed);
  /// Objects, materials or joints have changed: call before the next step.
  void invalidate() { listed_ = false; }
  /// Handles of the colliders, as they stand in the tables.
  void set_colliders(std::vector<ColliderId> ids);
  /// Call `invalidate` after a change.
  RigidJoints& joints() { return *joints_; }
  const RigidJoints& joints() const { return *joints_; }
  /// Index of an object's body, by which ties refer to it until objects change.
  std::uint32_t index(std::uint32_t object) const;
  /// Mass and principal moments, pose and velocity of an object's body; null if the object is none.
  const RigidDefinition* definition(std::uint32_t object) const;
  const BodyPose* pose(std::uint32_t object) const;
  const BodyVelocity* velocity(std::uint32_t object) const;
  /// Call when the object's particles have been moved as one, or given velocities. The body follows at the next step.
  void place(std::uint32_t object, const BodyPose& pose);
  void set_velocity(std::uint32_t object, const BodyVelocity& velocity);
  /// The body's velocity, with the changes of its particles' velocities since the last step.
  BodyVelocity velocity_now(const Particles& particles, const Object& object) const;
  /// Changes the body's velocity and those of its particles, also during a step.
  void change_velocity(Particles& particles, const Object& object, const BodyVelocity& change);
  /// Applies an impulse [N s] at a point [m], and an angular impulse [N m s].
  void apply_impulse(Particles& particles, const Object& object, const Vec3d& point, const Vec3d& impulse,
                     const Vec3d& angular_impulse);

  // --- as a part of AngularMomentum

  /// Whether forces move it.
  bool is_free(std::uint32_t object) const;
  /// Adds mass, position, momentum and angular momentum relative to the origin. h > 0: those that it will have if the substep,
  /// of length h, ends now [s].
  void add_to(RigidSums& sums, std::uint32_t object, const Vec3d& origin, double h) const;
  /// Where a particle was when the substep began, of a body or not [m].
  Vec3d start_of(const ObjectsView& objects, std::uint32_t particle) const;
  /// Sum of the moments of a contact that no collider makes [kg m^2]. `finish` takes it back from a body.
  Vec3d moment_of(const ObjectsView& objects, const ContactImpulse& contact) const;
  /// Whether other bodies or colliders pushed it in this substep.
  bool is_pushed(std::uint32_t object) const;

  // --- kinematic bodies, which prescribed motion moves

  bool is_kinematic(std::uint32_t object) const;
  /// Without a path a kinematic body stays where it is, or moves as `move` says.
  void set_kinematic(std::uint32_t object, bool kinematic);
  /// Moves the pose at which the body was added along a path.
  void set_path(std::uint32_t object, ColliderMotion path);
  /// The pose at the end of the next step.
  void move(std::uint32_t object, const BodyPose& pose);
  /// The pose on the path at a time [s]; else the current one.
  BodyPose path_pose(std::uint32_t object, double time) const;
  /// Before a step of dt: velocities of kinematic bodies and of their particles.
  void aim(const StageView& stage, double dt);

  // --- a step

  /// Reads the velocities of the particles, and finds the contacts of bodies with each other, with colliders and with
  /// obstacles that keep their shape.
  void begin_step(const StageView& stage, const ContactTables& tables, double dt);
  /// After the prediction of particles: forces on them move the bodies.
  void predict(const StageView& stage, const Substep& substep);
  /// Makes the bodies rigid after other stages have moved particles.
  void gather(const StageView& stage);
  /// Before the contacts of a substep are found: particles show the masses that contacts see.
  void split_masses(const StageView& stage);
  /// Counts the particles of each body that `contacts` touch in this substep. Returns whether masses were split again,
  /// because they are more than before.
  bool count_touched(const StageView& stage, std::span<Projector* const> contacts);
  /// Before the solver: ties hold, and particles carry the mass of bodies that are tied to them.
  void begin_ties(const StageView& stage, const Substep& substep, Ties& ties);
  /// After the solver: gathers, repeats the contacts with particles, then solves ties, joints and contacts of bodies.
  /// Writes the particles, which do not move until `finish`.
  void solve(const StageView& stage, const Substep& substep, Contacts& contacts, Ties& ties);
  /// After the new velocities: finds those of bodies, and sets their particles to them.
  void finish(const StageView& stage, const Substep& substep, const Contacts& contacts);
  /// After stages that change velocities.
  void gather_velocities(const StageView& stage);

  /// Keeps the state of the bodies, or returns to what was kept.
  void keep();
  void undo();

  /// The largest overlap of two bodies, or of a body and a collider [m].
  double deepest() const;
  /// Number of contact points that pushed in the last substep.
  std::size_t push_count() const;
  /// These points. A body is named by its particle that is nearest to the point, or if `nearest` is false by its first.
  void append_pushes(const StageView& stage, bool nearest, std::vector<ContactPush>& out) const;

  /// State that one step passes to the next.
  void save(SavedBytesWriter& out) const;
  /// Reads a saved state. Throws Error if it is none of these bodies.
  SavedRigidBodies read(SavedBytes& in) const;
  void set(SavedRigidBodies saved);
  std::size_t bytes() const;

 private:
  /// Motion of a kinematic body.
  struct Drive {
    std::shared_ptr<const ColliderMotion> path;  ///< null: from `from` to `to`
    BodyPose from{}, to{};
    double start = 0, length = 0;  ///< of the current step [s]
  };
  struct Record {
    std::uint32_t object = 0;  ///< id
    RigidDefinition definition;
    BodyPose pose;
    BodyVelocity velocity;
    BodyPose kept_pose;
    BodyVelocity kept_velocity;
    double shown = 0;  ///< number of touched particles that their masses are made for: it falls slowly
    std::uint32_t touched = 0;   ///< in this substep
    std::uint32_t chosen = 0;    ///< of the contacts that are repeated
    bool held = false;           ///< in this substep, at its start
    Vec3d moment;                ///< of contacts with particles, of both sides [kg m^2]
    std::optional<Drive> drive;  ///< of a kinematic body
    std::vector<Vec3d> arms;     ///< of the particles from the center, in world axes, turned by `arms_at` [m]
    Quatd arms_at{0, 0, 0, 0};
    std::vector<Vec3f> written;  ///< what write_positions wrote last, in this substep
  };
  /// Bodies that hold each other in a substep, or one alone.
  struct HeldSet {
    RigidSums sums;  ///< relative to the origin
    Vec3d origin;    ///< near them [m]
    std::uint32_t bodies = 0;
    bool any_held = false;
    bool alone = true;  ///< nothing else holds them
  };
  /// The body of a record, of a collider or of an obstacle, as the contacts see it.
  class Materials;

  Record* find(std::uint32_t object);
  const Record* find(std::uint32_t object) const;
  void list_bodies(const StageView& stage, const ContactTables& tables);
  std::uint32_t body_of(const JointSide& side) const;
  bool is_collider(std::size_t body) const {
    return body >= records_.size() && body < records_.size() + colliders_.size();
  }
  const Object& object_of(std::size_t body) const;
  /// The motion of a collider or an obstacle.
  const ColliderMotion& motion_of(std::size_t body) const;
  void list_obstacles(const StageView& stage);
  void place_colliders(const StageView& stage, const Substep& substep);
  static BodyPose pose_at(const Record& record, double time);
  BodyMass mass_of(std::size_t body) const;
  void place_kinematic(const StageView& stage, const Substep& substep);
  void end_kinematic(const StageView& stage, const Substep& substep);
  bool pushes(const RigidContact& contact) const;
  /// Calls f(body) for every body that is awake, on all threads.
  template <class F>
  void for_each_awake(const StageView& stage, F&& f);
  std::span<const Vec3d> arms(std::size_t body, const Quatd& rotation);
  void write_positions(const StageView& stage, std::size_t body, const BodyPose& pose);
  void read_velocities(const StageView& stage, std::size_t body);
  void write_velocities(const StageView& stage, std::size_t body);
  bool is_as_written(const StageView& stage, std::size_t body) const;
  template <class Count>
  void split_masses(const StageView& stage, const Count& count_of);
  void gather_body(const StageView& stage, std::size_t body);
  void hold(const StageView& stage, std::span<const Pinch> pinches);
  void repeat_contacts(const StageView& stage, Contacts& contacts);
  void sum_moments(const StageView& stage, const Contacts& contacts);
  void take_pushes(const StageView& stage, const Substep& substep, std::span<const BodyPush> pushes);
  void share_pushes(const StageView& stage, std::size_t body, double inverse_h,
                    std::span<const BodyPush> pushes);
  void solve_bodies(const StageView& stage, const Substep& substep, Ties& ties);
  void find_in_turns(const Ties& ties);
  bool is_awake(std::size_t body) const;
  bool is_held(const StageView& stage, std::size_t body) const;

  std::vector<Record> records_;         // ascending by id
  std::vector<const Object*> objects_;  // per record
  std::vector<std::uint32_t> rows_;     // per body: row of its object or column of its collider in the tables
  std::vector<const Collider*> colliders_;                // after the records
  std::vector<const Object*> obstacles_;                  // after the colliders
  std::vector<std::shared_ptr<const MeshShape>> meshes_;  // of the obstacles
  std::vector<std::uint32_t> mesh_ids_;                   // ids of the obstacles at the last listing
  std::size_t first_obstacle_ = 0;                        // its body at the last listing
  std::vector<ColliderId> collider_ids_;                  // as in the tables
  const ContactTables* tables_ = nullptr;
  RigidBodies bodies_;  // records, then colliders and obstacles
  std::vector<RigidShape> shapes_;
  std::vector<BodyPose> predicted_;
  std::vector<std::uint64_t> touched_at_;  // per particle: the count in which it was last touched
  std::uint64_t counts_ = 0;
  DisjointSets holding_;                // bodies that hold each other
  std::vector<HeldSet> held_sets_;      // at the root of each
  std::vector<std::uint8_t> in_turns_;  // per body: joints or ties hold it
  ContactFinder finder_;
  ContactSolver solver_;
  std::unique_ptr<RigidJoints> joints_;
  bool listed_ = false;  // the arrays of bodies are those of the records
  bool fresh_ = true;    // contacts were found at these poses
  double h_ = 0;         // length of the last substep [s]
};

}  // namespace souple
