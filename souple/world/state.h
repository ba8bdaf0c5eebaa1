#pragma once

// What a World holds, for the files of this folder only; users see world.h.

#include "souple/collision/collider.h"
#include "souple/collision/collider_contacts.h"
#include "souple/collision/feature_contacts.h"
#include "souple/collision/particle_contacts.h"
#include "souple/collision/surface_contacts.h"
#include "souple/collision/untangling.h"
#include "souple/constraints/attachment.h"
#include "souple/constraints/distance.h"
#include "souple/geometry/embedding.h"
#include "souple/solver/custom_constraint.h"
#include "souple/solver/projector.h"
#include "souple/solver/set_projector.h"
#include "souple/state/particles.h"
#include "souple/world/flow.h"
#include "souple/world/fluids.h"
#include "souple/world/sleeping.h"
#include "souple/world/world.h"

#include <array>
#include <exception>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace souple {

using Material = std::variant<ClothMaterial, SoftBodyMaterial, RopeMaterial, GrainsMaterial, ObstacleMaterial,
                              FluidMaterial>;

/// A particle held by a pin: it goes to target(vertex, t) + offset, or stays where it is when there is no
/// target.
struct PinnedParticle {
  std::uint32_t particle = 0;  ///< within the object
  std::uint32_t vertex = 0;    ///< user order
  Vec3d offset{};              ///< from the vertex to the particle when it was pinned [m]
  std::shared_ptr<const Target> target;
};

/// Everything that says what an object is. Its constraints are a pure function of this (see build.h).
struct Object {
  ObjectId id;
  std::string name;
  ObjectKind kind = ObjectKind::cloth;
  Material material;
  std::uint32_t begin = 0, end = 0;        ///< particles
  std::uint32_t capacity = 0;              ///< of a fluid: it may have so many; of others: as many as it has
  TriangleMesh mesh;                       ///< as given, placed; positions are the rest state; may be empty
  TetMesh tets;                            ///< soft bodies: vertices are the particles, in order
  std::vector<Vec3d> rest;                 ///< of each particle [m]
  std::vector<std::uint32_t> particle_of;  ///< user vertex -> particle within the object; empty when embedded
  std::vector<std::uint32_t> vertex_of;    ///< particle -> one user vertex on it, or near it when embedded
  std::optional<Embedding> embedding;      ///< user vertices in `tets`, when they are no particles
  /// Triangles over particles, for wind and pressure; may be empty.
  std::vector<std::array<std::uint32_t, 3>> surface;
  /// Made of `surface` when the wind first blows: triangles [triangle_begin[i], triangle_begin[i + 1]) of
  /// triangles_of touch particle i, in ascending order.
  std::vector<std::uint32_t> triangle_begin, triangles_of;
  std::vector<std::uint32_t> surface_source;  ///< cloth: per triangle of `surface`, its index in `mesh`;
                                              ///< empty: the same
  std::vector<float> stiffness_map;           ///< per particle; empty: 1
  std::vector<float> thickness_map;           ///< per particle; empty: 1
  std::vector<float>
      embedding_offset;  ///< per particle: how far it lies outside an embedded surface [m]; or empty
  std::vector<PinnedParticle> pins;                        ///< ascending by particle
  bool self_collision = false;                             ///< its surface touches itself
  int layer = 0;                                           ///< of cloth; 0: none
  CollisionFilter filter;                                  ///< which other things it meets
  float pressure = 0;                                      ///< Pa
  std::optional<std::pair<float, float>> enclosed_volume;  ///< factor, compliance
  double rest_time = 0;                                    ///< for how long it has been at rest by now [s]
  std::uint32_t island = 0;  ///< that it sleeps with, named by one of its objects' ids; 0: awake
  ObstacleMotion motion;     ///< of an obstacle
  Transform placement;       ///< of an obstacle: applied to its sequence

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

/// The user-order mirror of an object; refreshed lazily.
struct Mirror {
  std::uint64_t version = 0;  ///< of the state that the positions show
  std::uint64_t velocities_version = 0, normals_version = 0;
  std::vector<Vec3f> positions, velocities, normals;

  // What normals are computed with, made when they are first asked for.
  VertexTriangles triangles_of;
  std::vector<Vec4f> position_records, area_normals;
};

/// A projector that does not come from one object alone: attachments, ties, tethers, the user's own.
struct UserConstraint {
  /// The k-th constraint of an attachment goes where target(vertex, t) + offset is.
  struct AttachedVertex {
    std::uint32_t vertex = 0;
    Vec3d offset{};
  };

  ProjectorId id;
  std::unique_ptr<Projector> projector;
  SetProjector<Attachment>* attachment = nullptr;    ///< `projector`, when it has a target
  SetProjector<Distance>* distance_joint = nullptr;  ///< `projector`, when it ties vertices together
  bool is_custom = false;                            ///< it may pull otherwise at any time
  std::optional<double> until;                       ///< when a tie is let go of [s]
  bool is_active = true;                             ///< it was not yet when the last step began
  Target target;
  std::vector<AttachedVertex> attached_vertices;

  void update_targets(double t);
  /// Particles [begin, end) cease to exist.
  void erase_particles(std::uint32_t begin, std::uint32_t end);
};

struct ColliderRecord {
  ColliderId id;
  ColliderOptions options;
  Shape shape;
};

/// What the contact projectors look up during a step; built from objects and colliders.
struct ContactTables {
  std::vector<ContactObject> objects;
  std::vector<Collider> colliders;
  std::vector<std::vector<Edge>> rope_edges;  ///< of each object; empty but for ropes
  ContactMaterialTable against_colliders, against_objects;
};

/// Sums over particles, about a point near them: mass, m x, m v, m x x^T (lower triangle), m x cross v.
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
  std::uint64_t version = 1;  ///< grows whenever positions may have changed

  Particles particles;
  std::vector<Vec4f> predicted;          ///< p* of explicit and implicit integration
  std::vector<Vec4f> force;              ///< of the wind on particles [N]
  std::vector<Vec4f> triangle_force;     ///< a third of that on each triangle of the object at hand [N]
  std::vector<RigidSums> rigid_sums;     ///< of each chunk of the object that is damped
  std::vector<std::uint32_t> object_of;  ///< per particle: index into objects

  std::vector<std::unique_ptr<Object>> objects;  ///< stable addresses
  std::vector<ColliderRecord> colliders;
  std::vector<EmitterRecord> emitters;
  std::vector<DrainRecord> drains;
  std::uint32_t next_id = 1;

  std::vector<std::unique_ptr<Projector>>
      object_constraints;  ///< built from the objects, in the order they are solved
  std::vector<UserConstraint> user_constraints;
  std::vector<Projector*> order;  ///< all of them, contacts last, as the solver sees them
  std::unique_ptr<Solver> solver;
  std::unique_ptr<Threads> threads;  ///< null: make them before the next step
  ColliderContacts collider_contacts;
  FeatureContacts feature_contacts;
  ParticleContacts particle_contacts;
  SurfaceContacts surface_contacts;
  Untangling untangling;
  Fluids fluids;
  bool check_intersections = true;  ///< something was put where nothing led it
  ContactTables tables;
  PairOverrides pairs;
  bool dirty_constraints = true;  ///< objects or materials changed: build before the next step
  bool dirty_tables = true;       ///< so did what contacts look up
  bool dirty_counts = false;      ///< fluids have more or fewer particles than contacts know of
  bool dirty_solver = true;       ///< projectors came or went: make and prepare the solver anew
  void dirty_all() { dirty_constraints = dirty_tables = true; }

  std::vector<ForceField> force_fields;
  std::array<std::vector<std::function<void(World&)>>, stage_count> before, after;
  std::function<void(LogLevel, std::string_view)> log;

  StepReport report;
  std::vector<ContactEvent> events;
  SleepScratch sleep;
  bool contacts_valid = false;  ///< the contact projectors hold what the last step left, and may be read
  bool events_valid = false;    ///< `events` are made of them
  void invalidate_contacts() { contacts_valid = events_valid = false; }
  std::vector<Vec4f> last_valid_position, last_valid_offset, last_valid_velocity;  ///< the last good state
  mutable std::map<std::uint32_t, Mirror> mirrors;                                 ///< by object id

  std::optional<std::size_t> first_non_finite;  ///< the first particle whose number went bad in this step
  bool stepping = false;  ///< inside World::step: callbacks may look and push, not add or remove

  /// Throws when the handle is stale.
  Object& object(ObjectId id);
  const Object& object(ObjectId id) const;
  ColliderRecord& collider(ColliderId id);
  ParticleView view();

  /// Position of a particle with what float cannot hold. [m]
  Vec3d exact_position(std::size_t i) const {
    return Vec3d(particles.position[i].xyz()) + Vec3d(particles.offset[i].xyz());
  }
  /// Puts a particle at x, keeping in the displacement form what float cannot hold.
  void set_position(std::size_t i, const Vec3d& x);
  /// The same where it may tangle what it belongs to.
  void teleport_particle(std::size_t i, const Vec3d& x);

  /// `wanted` when it is free, else throws; empty: `base`, base2, base3, ... whichever is free first.
  std::string unique_name(const std::string& wanted, std::string_view base) const;
  void require_free_name(std::string_view name) const;
  void require_between_steps(std::string_view what) const;

  /// Calls f(projector) for all of them in the order they are solved: standard, user_constraints, contacts.
  template <class Function>
  void for_each_projector(const Function& f) {
    for_each_constraint_projector(f);
    f(surface_contacts);
    f(particle_contacts);
    f(feature_contacts);
    f(collider_contacts);
  }

  /// All but the contacts, in the same order.
  template <class Function>
  void for_each_constraint_projector(const Function& f) {
    for (const auto& projector : object_constraints) f(*projector);
    for (const UserConstraint& user_constraint : user_constraints)
      if (user_constraint.is_active) f(*user_constraint.projector);
  }

  ProjectorId add_user_constraint(UserConstraint user_constraint, std::unique_ptr<Projector> projector);

  /// Sets a flag of the report and adds a line to its message.
  void warn(Flag flag, std::string_view words);
  /// Tells the log what was mended in an object's mesh.
  void log_info(const std::string& name, const std::vector<std::string>& sentences) const;
  /// Calls what may throw (users' callbacks); an exception becomes Flag::callback_failed.
  template <class Function>
  void guarded(std::string_view what, const Function& f) {
    try {
      f();
    } catch (const std::exception& error) {
      warn(Flag::callback_failed, std::string(what) + " threw: " + error.what());
    } catch (...) {
      warn(Flag::callback_failed, std::string(what) + " threw something that is no std::exception");
    }
  }
};

}  // namespace souple
