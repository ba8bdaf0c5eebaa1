#pragma once

// Internal state of a World, for the files of this folder. Users include world.h.

#include "souple/contacts/contacts.h"
#include "souple/geometry/embedding.h"
#include "souple/solver/projector.h"
#include "souple/state/particles.h"
#include "souple/world/arrivals.h"
#include "souple/world/balance.h"
#include "souple/world/callback_list.h"
#include "souple/world/contact_tracker.h"
#include "souple/world/flow.h"
#include "souple/world/fluids.h"
#include "souple/world/name_registry.h"
#include "souple/world/query_index.h"
#include "souple/world/set_kinds.h"
#include "souple/world/sleeping.h"
#include "souple/world/world.h"

#include <array>
#include <exception>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace souple {

using Material = std::variant<ClothMaterial, SoftBodyMaterial, RopeMaterial, GrainsMaterial, ObstacleMaterial,
                              FluidMaterial>;

/// A pinned particle. Its position is target(vertex, t) + offset, or constant without a target.
struct PinnedParticle {
  std::uint32_t particle = 0;  ///< index within the object
  std::uint32_t vertex = 0;    ///< user order
  Vec3d offset{};              ///< from the vertex to the particle at the time of pinning [m]
  std::shared_ptr<const Target> target;
  // See World::move_pins.
  Vec3d pinned_at{};             ///< position of the particle when it was pinned [m]
  Vec3d from{};                  ///< start of the step [m]
  std::optional<Vec3d> arrival;  ///< end of the next step [m]
};

template <class Kind>
class SetProjector;
struct Attachment;
struct Distance;
struct ConstraintSets;
struct ObjectConstraints;

/// The definition of an object. Its constraints are a pure function of this struct (see build.h).
struct Object {
  ObjectId id;
  std::string name;
  ObjectKind kind = ObjectKind::cloth;
  Material material;
  std::uint32_t begin = 0, end = 0;  ///< range of its particles
  /// Fluids: largest number of particles; other kinds: their number of particles.
  std::uint32_t capacity = 0;
  TriangleMesh mesh;        ///< as added, transformed; its positions are the rest state; may be empty
  TetMesh tets;             ///< soft bodies: vertices are the particles, in order
  std::vector<Vec3d> rest;  ///< rest position of each particle [m]
  std::vector<std::uint32_t> particle_of;  ///< user vertex -> particle within the object; empty if embedded
  std::vector<std::uint32_t> vertex_of;    ///< particle -> a user vertex at it, or near it if embedded
  std::optional<Embedding> embedding;      ///< user vertices in `tets`, if they are not particles
  /// Triangles over particles, for wind and pressure; may be empty.
  std::vector<std::array<std::uint32_t, 3>> surface;
  /// Triangles of each particle, computed from `surface` at the first wind: particle i belongs to the
  /// triangles triangles_of[k] with triangle_begin[i] <= k < triangle_begin[i + 1], in ascending order.
  std::vector<std::uint32_t> triangle_begin, triangles_of;
  /// Cloth and obstacles: index in `mesh` of each triangle of `surface`; empty: identity.
  std::vector<std::uint32_t> surface_source;
  std::vector<float> stiffness_map;  ///< per particle; empty: 1
  std::vector<float> thickness_map;  ///< per particle; empty: 1
  /// Per particle: distance outside the embedded surface [m]; may be empty.
  std::vector<float> embedding_offset;
  std::vector<PinnedParticle> pins;                        ///< ascending by particle
  std::vector<std::uint32_t> pin_guess;                    ///< per particle: its last known index in `pins`
  bool self_collision = false;                             ///< the surface collides with itself
  int layer = 0;                                           ///< cloth layer; 0: none
  CollisionFilter filter;                                  ///< with which other objects it collides
  float pressure = 0;                                      ///< Pa
  std::optional<std::pair<float, float>> enclosed_volume;  ///< factor and compliance
  double rest_time = 0;                                    ///< time at rest so far [s]
  std::uint32_t island = 0;  ///< id of the sleeping island: that of one of its objects; 0: awake
  Imbalance imbalance;       ///< of cloths, soft bodies and ropes
  ObstacleMotion motion;     ///< of obstacles
  Transform placement;       ///< of obstacles: transform of the mesh sequence
  float wind_exposure = 1;   ///< share of the wind's velocity
  std::uint64_t user_data = 0;

  std::unique_ptr<ConstraintSets>
      fresh;  ///< constraints built since the last build_constraints, of fresh_kinds
  SetKinds fresh_kinds;
  std::uint32_t merged_begin = 0,
                merged_end = 0;  ///< its particles at the last build_constraints; equal: none

  Object();
  ~Object();

  std::uint32_t reserved_end() const { return begin + capacity; }
  std::uint32_t particle_count() const { return static_cast<std::uint32_t>(rest.size()); }
  std::size_t vertex_count() const { return embedding ? mesh.positions.size() : particle_of.size(); }
  /// Mean of a per-particle map over a constraint's particles; 1 without a map.
  template <class Indices>
  float mean(const std::vector<float>& map, const Indices& particles_of_constraint) const {
    if (map.empty()) return 1;
    float sum = 0;
    for (const std::uint32_t i : particles_of_constraint) sum += map[i];
    return sum / static_cast<float>(std::size(particles_of_constraint));
  }
};

/// Copy of an object's state in user order, updated on demand.
struct Mirror {
  std::uint64_t version = 0;  ///< WorldState::version of `positions`
  std::uint64_t velocities_version = 0, normals_version = 0, angular_velocities_version = 0;
  std::vector<Vec3f> positions, velocities, normals, angular_velocities;

  // Data for the normals, built on first use.
  VertexTriangles triangles_of;
  std::vector<Vec4f> position_records, area_normals;
};

/// A constraint set that is not built from one object: attachments, distance joints, tethers, user
/// projectors.
struct UserConstraint {
  /// Target of the k-th constraint of an attachment: target(vertex, t) + offset.
  struct AttachedVertex {
    std::uint32_t vertex = 0;
    Vec3d offset{};
  };

  ProjectorId id;
  std::unique_ptr<Projector> projector;
  SetProjector<Attachment>* attachment = nullptr;    ///< `projector`, if it is an attachment
  SetProjector<Distance>* distance_joint = nullptr;  ///< `projector`, if it consists of distance joints
  bool is_custom = false;                            ///< user projector; its forces may change at any time
  std::optional<double> until;                       ///< release time of distance joints [s]
  bool is_active = true;                             ///< had not been released when the last step started
  Target target;
  std::vector<AttachedVertex> attached_vertices;

  void update_targets(double t);
  /// Removes the particles [begin, end).
  void erase_particles(std::uint32_t begin, std::uint32_t end);
};

struct ColliderRecord {
  ColliderId id;
  ColliderOptions options;
  Shape shape;
  std::shared_ptr<Arrival> arrival{};  ///< `options.motion`, once move_collider has set it
  ColliderMotion given{};              ///< the motion before
  std::uint64_t user_data = 0;
};

/// A soft body at an impact, see body_restitution.h.
struct BodyAtImpact {
  std::uint32_t object = 0;
  double mass = 0;   ///< 0: does not move as a whole [kg]
  Vec3d velocity{};  ///< of the center of mass [m/s]
  Vec3d change{};    ///< by the impacts so far [m/s]
};

/// Sums over particles relative to a point near them: mass, m x, m v, m x x^T (lower triangle), m x cross v.
struct RigidSums {
  double mass = 0;
  Vec3d position, momentum;
  std::array<double, 6> second{};
  Vec3d angular;
};

struct WorldState {
  Settings settings;
  double time = 0;
  std::uint64_t steps = 0;
  std::uint64_t version = 1;  ///< increases whenever positions may have changed

  Particles particles;
  std::vector<Vec4f> predicted;       ///< p* of the explicit and implicit integrators
  std::vector<Vec4f> force;           ///< per particle: wind force [N]
  std::vector<Vec4f> triangle_force;  ///< per triangle of the current object: a third of the wind force [N]
  std::vector<RigidSums> rigid_sums;  ///< per chunk of the object being damped
  std::vector<std::uint32_t> object_of;  ///< per particle: index into objects

  std::vector<std::unique_ptr<Object>> objects;  ///< ascending by id; addresses are stable
  std::vector<ColliderRecord> colliders;         ///< ascending by id
  NameRegistry names;                            ///< of objects and colliders
  std::vector<EmitterRecord> emitters;
  std::vector<DrainRecord> drains;
  std::uint32_t next_id = 1, next_callback_id = 1;

  WorldState();
  ~WorldState();

  std::unique_ptr<ObjectConstraints> constraints_of_objects;  ///< see build.h
  std::vector<Projector*> object_constraints;  ///< those that are not empty, in order of solution
  std::vector<UserConstraint> user_constraints;
  std::vector<Projector*> order;  ///< all projectors in order of solution, contacts last
  std::unique_ptr<Solver> solver;
  SolverSettings solver_settings;    ///< those that `solver` was made with
  std::unique_ptr<Threads> threads;  ///< null: create before the next step
  JobSystem* jobs = nullptr;         ///< the host's, in place of our threads
  Contacts contacts;
  Balance balance;
  bool last_substep = false;               ///< of a step
  double step_start = 0, step_length = 1;  ///< of the current step [s]
  Fluids fluids;
  bool check_intersections = true;             ///< an object was placed without continuous motion
  std::vector<Impact> impacts;                 ///< of the substep, see body_restitution.h
  std::vector<BodyAtImpact> bodies_at_impact;  ///< bodies at impacts
  ContactTables tables;  ///< built from objects and colliders, read by `contacts` in a step
  PairOverrides pairs;
  bool dirty_constraints = true;  ///< constraints of objects changed: merge them before the next step
  bool dirty_objects = true;      ///< objects were added or removed
  bool dirty_groups = true;       ///< shape matching or enclosed volumes changed
  bool dirty_radii = true;        ///< contact radii changed
  bool dirty_tables = true;       ///< input of the contacts changed: rebuild the tables
  bool dirty_counts = false;      ///< the particle count of a fluid differs from the contacts' count
  bool dirty_solver = true;  ///< projectors were added or removed, or settings changed: prepare the solver
  bool dirty_masses = true;  ///< particles were pinned or freed, or masses changed: prepare the solver
  void dirty_all() { dirty_constraints = dirty_objects = dirty_tables = true; }

  CallbackList<VertexForceField> force_fields;
  std::array<CallbackList<std::function<void(World&)>>, stage_count> before, after;
  void erase_removed_callbacks();
  std::function<void(LogLevel, std::string_view)> log;
  /// Warnings of the last and of the current step without their numbers: the log has each once until it clears.
  std::vector<std::string> warned_before, warned;

  StepReport report;
  std::vector<ContactEvent> events;
  SleepScratch sleep;
  bool contacts_valid = false;  ///< `contacts` holds the result of the last step and may be read
  bool events_valid = false;    ///< `events` match these contacts
  void invalidate_contacts() { contacts_valid = events_valid = false; }
  std::vector<Vec4f> last_valid_position, last_valid_offset, last_valid_velocity,
      last_valid_spin;  ///< state before the step
  ContactTracker contact_tracker;
  mutable std::map<std::uint32_t, Mirror> mirrors;  ///< by object id
  mutable QueryIndex query_index;
  /// Const functions that fill `mirrors`, `query_index` or `events` hold it meanwhile.
  mutable std::mutex cache_lock;

  std::optional<std::size_t> first_non_finite;  ///< in this step: the lowest particle with a non-finite value
  /// Inside World::step: callbacks may read and apply forces, but not add or remove objects.
  bool stepping = false;

  /// Null if the handle is stale.
  Object* find_object(ObjectId id) const;
  /// Throws if the handle is stale.
  Object& object(ObjectId id);
  const Object& object(ObjectId id) const;
  ColliderRecord& collider(ColliderId id);
  ParticleView view();

  /// Position of a particle, including the part beyond float precision [m].
  Vec3d exact_position(std::size_t i) const {
    return Vec3d(particles.position[i].xyz()) + Vec3d(particles.offset[i].xyz());
  }
  /// Sets the position of a particle; the displacement form keeps the part beyond float precision in the
  /// offset.
  void set_position(std::size_t i, const Vec3d& x);
  /// Sets a position without continuous motion, which may create intersections: requests a check.
  void teleport_particle(std::size_t i, const Vec3d& x);

  /// `wanted` if it is free, else throws; empty: the first free name of `base`, base2, base3, ...
  std::string unique_name(const std::string& wanted, std::string_view base) const;
  void require_between_steps(std::string_view what) const;

  /// Calls f(projector) for all projectors in order of solution: objects' constraints, user constraints,
  /// contacts.
  template <class Function>
  void for_each_projector(const Function& f) {
    for_each_constraint_projector(f);
    for (const auto& kind : contacts.kinds()) f(*kind);
  }

  /// Calls f for all projectors except contacts, in the same order.
  template <class Function>
  void for_each_constraint_projector(const Function& f) {
    for (const auto& projector : object_constraints) f(*projector);
    for (const UserConstraint& user_constraint : user_constraints)
      if (user_constraint.is_active) f(*user_constraint.projector);
  }

  ProjectorId add_user_constraint(UserConstraint user_constraint, std::unique_ptr<Projector> projector);

  /// Sets a flag of the report and appends a line to its message.
  void warn(Flag flag, std::string_view words);
  /// Logs notes about an object, such as repairs of its mesh.
  void log_info(const std::string& name, const std::vector<std::string>& sentences) const;
  /// Runs code that may throw, such as users' callbacks; an exception sets Flag::callback_failed.
  template <class Function>
  void guarded(std::string_view what, const Function& f) {
    try {
      f();
    } catch (const std::exception& error) {
      warn(Flag::callback_failed, std::string(what) + " threw: " + error.what());
    } catch (...) {
      warn(Flag::callback_failed, std::string(what) + " threw an exception that is not a std::exception");
    }
  }
};

}  // namespace souple
