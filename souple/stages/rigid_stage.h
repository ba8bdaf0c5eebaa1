#pragma once

#include "souple/objects/rigid_definition.h"
#include "souple/rigid/contact_finder.h"
#include "souple/rigid/contact_solver.h"
#include "souple/stages/rigid_joints.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace souple {

struct Collider;
struct ContactTables;
struct Object;
class Projector;
struct StageView;
struct Substep;

/// The rigid bodies of a world in its step. Their particles are points of their surfaces: the body moves them, and what
/// pushes them pushes the body. Between a push and the next call here a body is not rigid; each call makes it so again.
///
/// An impulse J on a particle is its change of position times its mass over h, or its change of velocity times its mass;
/// impulses are exact, whatever mass the particle shows to others. While contacts are solved that is a part of the body's
/// mass: where n of its particles are touched, each shows an n-th (mass splitting, Tonge et al. 2012, "Mass splitting for
/// jitter-free parallel rigid body simulation"). So all together push the body no farther than each of them was pushed.
class RigidStage {
 public:
  bool empty() const { return records_.empty(); }
  void add(std::uint32_t object, RigidDefinition definition);
  void remove(std::uint32_t object);
  /// Objects, materials or joints have changed: call before the next step.
  void invalidate() { listed_ = false; }
  /// Handles of the colliders, as they stand in the tables.
  void set_colliders(std::vector<ColliderId> ids);
  /// Call `invalidate` after a change.
  RigidJoints& joints() { return joints_; }
  const RigidJoints& joints() const { return joints_; }
  /// Mass and principal moments, pose and velocity of an object's body; null if the object is none.
  const RigidDefinition* definition(std::uint32_t object) const;
  const BodyPose* pose(std::uint32_t object) const;
  const BodyVelocity* velocity(std::uint32_t object) const;
  /// The object's particles have been moved as one, or given velocities: the body follows at the next step.
  void place(std::uint32_t object, const BodyPose& pose);
  void set_velocity(std::uint32_t object, const BodyVelocity& velocity);

  // --- a step

  /// Reads the velocities of the particles, and finds the contacts of bodies with each other and with colliders.
  void begin_step(const StageView& stage, const ContactTables& tables, double dt);
  /// After the prediction of particles: what forces did to them moves the bodies.
  void predict(const StageView& stage, const Substep& substep);
  /// Makes the bodies rigid after other stages have moved particles. `in_contact`: these were contacts, which
  /// count_touched counted.
  void gather(const StageView& stage, bool in_contact);
  /// Before the contacts of a substep are found: particles show the masses that contacts see.
  void split_masses(const StageView& stage);
  /// Counts the particles of each body that `contacts` touch in this substep.
  void count_touched(const StageView& stage, std::span<Projector* const> contacts);
  /// After the solver: gathers, solves the joints and contacts of bodies, and writes the particles, which nothing moves until
  /// `finish`.
  void solve(const StageView& stage, const Substep& substep);
  /// After the new velocities: those of bodies, and particles as the body has them.
  void finish(const StageView& stage, const Substep& substep);
  /// After stages that change velocities.
  void gather_velocities(const StageView& stage);

  /// Keeps the state of the bodies, or returns to what was kept.
  void keep();
  void undo();

  /// The largest overlap of two bodies, or of a body and a collider [m].
  double deepest() const;

  /// State that one step passes to the next.
  std::vector<std::byte> save() const;
  /// Throws Error if the bytes are not those of these bodies.
  void load(std::span<const std::byte> in);
  std::size_t bytes() const;

 private:
  struct Record {
    std::uint32_t object = 0;  ///< id
    RigidDefinition definition;
    BodyPose pose;
    BodyVelocity velocity;
    BodyPose kept_pose;
    BodyVelocity kept_velocity;
    double shown = 0;  ///< number of touched particles that their masses are made for: it falls slowly
    std::uint32_t touched = 0;  ///< in this substep
  };
  /// The body of a record, or of a collider, as the contacts see it.
  class Materials;

  Record* find(std::uint32_t object);
  const Record* find(std::uint32_t object) const;
  void list_bodies(const StageView& stage, const ContactTables& tables);
  std::uint32_t body_of(const JointSide& side) const;
  void place_colliders(const StageView& stage, const Substep& substep);
  void write_positions(const StageView& stage, std::size_t body, const BodyPose& pose) const;
  void read_velocities(const StageView& stage, std::size_t body);
  void write_velocities(const StageView& stage, std::size_t body) const;
  bool is_awake(std::size_t body) const;
  bool is_held(const StageView& stage, std::size_t body) const;

  std::vector<Record> records_;         // ascending by id
  std::vector<const Object*> objects_;  // per record
  std::vector<std::uint32_t> rows_;     // per body: row of its object or column of its collider in the tables
  std::vector<const Collider*> colliders_;  // after the records
  std::vector<ColliderId> collider_ids_;    // as in the tables
  const ContactTables* tables_ = nullptr;
  RigidBodies bodies_;  // records, then colliders
  std::vector<RigidShape> shapes_;
  std::vector<BodyPose> predicted_;
  std::vector<std::uint64_t> touched_at_;  // per particle: the count in which it was last touched
  std::uint64_t counts_ = 0;
  ContactFinder finder_;
  ContactSolver solver_;
  RigidJoints joints_;
  bool listed_ = false;  // the arrays of bodies are those of the records
  bool fresh_ = true;    // contacts were found at these poses
  double part_ = 1;      // of a step that a substep is
};

}  // namespace souple
