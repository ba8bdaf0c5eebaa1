#pragma once

#include "souple/collision/collider_motion.h"
#include "souple/collision/shapes.h"
#include "souple/error.h"
#include "souple/fluid/emitter.h"
#include "souple/fluid/foam_parameters.h"
#include "souple/geometry/lattice.h"
#include "souple/geometry/triangle_mesh.h"
#include "souple/math/transform.h"
#include "souple/objects/callbacks.h"
#include "souple/objects/handles.h"
#include "souple/objects/materials.h"
#include "souple/objects/object_options.h"
#include "souple/objects/obstacle_motion.h"
#include "souple/queries/query.h"
#include "souple/queries/selector.h"
#include "souple/stages/settings.h"
#include "souple/world/report.h"

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace souple {

namespace joint {
struct Kind;  // souple/rigid/joints/joint.h
}
struct DebugDraw;
class JobSystem;
struct JointOptions;
struct JointReport;
class JointSide;
struct KindTime;
struct MemoryReport;
class Projector;
struct SolveTime;
struct SurfacePoint;
struct TetMesh;  // souple/geometry/tet_mesh.h
struct TieId;
struct TieOptions;
struct TieReport;
class TieSide;
struct WorldState;

/// One vertex of one object.
struct VertexRef {
  ObjectId object;
  std::uint32_t vertex = 0;
};

/// A particle that moves a vertex, and its weight in the vertex position.
struct Carrier {
  std::uint32_t particle = 0;
  double weight = 1;
  float inverse_mass = 0;  ///< 1/kg; 0: pinned
  Vec3d position{};        ///< m
};

/// Spray, foam and bubbles of all fluids. The order of the particles changes from step to step. The spans are
/// valid until the next step.
struct FoamView {
  std::span<const Vec3f> positions;   ///< m
  std::span<const Vec3f> velocities;  ///< m/s
  std::span<const FoamKind> kinds;
};

/// All state that changes in a step, as bytes; see World::snapshot.
struct Snapshot {
  std::vector<std::byte> bytes;
};

/// Result of World::rigid_body.
struct RigidBodyState {
  Transform pose;            ///< of the body's frame: its center of mass [m], and its principal axes
  Vec3d velocity{};          ///< of the center of mass [m/s]
  Vec3d angular_velocity{};  ///< in world axes [rad/s]
  double mass = 0;           ///< kg
  Vec3d inertia{};           ///< about the principal axes [kg m^2]
  bool kinematic = false;    ///< see World::set_kinematic
};

/// Objects, colliders and the simulation loop. Meters, kilograms, seconds; Y up, right-handed.
///
/// All functions but `step` throw Error on invalid arguments and then leave the world unchanged. Between steps several
/// threads may call const functions at the same time, except elastic_energy, unconverged_energy and debug_draw. For all
/// other calls, only one thread may use the world.
///
/// A function that the world calls may call the world in turn, as the table says. Callbacks of a stage are those of
/// `before` and `after`. Others are force fields, targets of pins and attachments, motions of colliders, obstacles and
/// emitters, and the log function. CustomConstraint, Projector, JobSystem and the functions of DebugDraw also count as
/// others:
///
/// | function of World                                                                    | stage | others |
/// |--------------------------------------------------------------------------------------|-------|--------|
/// | const functions, but for the next two lines                                          | yes   | yes    |
/// | ray_cast, ray_cast_all, sphere_cast, closest_point, overlap, collider_pose, joint_report, tie_report | yes   | yes, but a motion that one of these asks for a pose may call none of them |
/// | contacts, pressures, foam, fluid_force, snapshot, memory, debug_draw, elastic_energy, unconverged_energy | yes | Error |
/// | before, after, add_force_field, clear_force_fields, remove of these; set_log         | yes   | Error  |
/// | set_positions, set_velocities, set_angular_velocities, teleport, apply_impulse, wake | yes   | Error  |
/// | set_body_velocity, apply_angular_impulse                                             | yes   | Error  |
/// | pin, unpin, set_wind_exposure, set_user_data, set_joint                              | yes   | Error  |
/// | all others: what adds, removes or changes objects, colliders, constraints, flows, pairs, settings; move_pins, move_collider, move_body, projector, restore, time_projections, time_solve | Error | Error |
/// | step                                                                                 | is refused; the report of the outer step says so | as before |
/// | moving, assigning to or destroying the world                                         | never | never  |
///
/// Exceptions of such a function. A callback of a stage, a force field, a target, a motion or
/// CustomConstraint::evaluate that throws loses its effect. Flag::callback_failed and the report's message say so. If
/// the log function throws, the report of this step or of the next one says so. Exceptions of a Projector, and
/// std::bad_alloc of any function, pass through `step`. A JobSystem must not throw. Functions called outside a step
/// (motions by queries and set_motion, DebugDraw) pass their exceptions to the caller.
///
/// A world that was moved from can be assigned to and destroyed. Its other functions throw Error, and `step` returns a
/// report that says so.
class World {
 public:
  explicit World(const Settings& settings = {});
  ~World();
  World(World&&) noexcept;
  World& operator=(World&&) noexcept;

  // --- the loop ----------------------------------------------------------------------------------
  /// Advances the world by dt seconds in `substeps` equal parts. Throws std::bad_alloc, and exceptions of a user's
  /// Projector, on whatever thread. The particles then return to their positions before the step. Until `restore`,
  /// functions that need more of the world than its objects (the next step, changes, snapshot, foam, ...) throw Error.
  /// All other problems stand in the report.
  const StepReport& step(double dt);
  /// Builds now what the next step would build: constraints, contact tables, the solver. Throws Error where that step
  /// would be refused.
  void prepare();
  const StepReport& report() const;
  double time() const;  ///< s
  const Settings& settings() const;
  void set_settings(const Settings& settings);
  /// The world computes on the threads of the host's job system, which must outlive the world or the next
  /// call; null: on its own (Settings::threads). The results are the same bits.
  void set_job_system(JobSystem* jobs);
  /// Adds a callback that runs before or after each execution of a stage, in order of addition. The step catches
  /// and reports its exceptions.
  CallbackId before(Stage stage, std::function<void(World&)> callback);
  CallbackId after(Stage stage, std::function<void(World&)> callback);
  /// Also in a callback of a stage, by itself too: it does not run again.
  void remove(CallbackId callback);

  // --- objects -----------------------------------------------------------------------------------
  ObjectId add_cloth(const TriangleMesh& mesh, const ClothMaterial& material = {},
                     const ObjectOptions& options = {});
  ObjectId add_soft_body(const TetMesh& mesh, const SoftBodyMaterial& material = {},
                         const ObjectOptions& options = {});
  /// Makes a soft body of a surface, closed but for small holes: a lattice of tets covers it (about 2000 tets by
  /// default). The surface is embedded in it; positions and triangles of the object are the surface's.
  ObjectId add_soft_body(const TriangleMesh& surface, const SoftBodyMaterial& material = {},
                         const LatticeOptions& lattice = {}, const ObjectOptions& options = {});
  /// Makes a rope along the polyline `points` [m], in `segments` pieces of equal length.
  ObjectId add_rope(std::span<const Vec3d> points, std::uint32_t segments, const RopeMaterial& material = {},
                    const ObjectOptions& options = {});
  ObjectId add_grains(std::span<const Vec3d> centers, const GrainsMaterial& material = {},
                      const ObjectOptions& options = {});
  /// Makes a fluid of particles about `spacing` apart. Throws if the options contain maps or self_collision.
  ObjectId add_fluid(std::span<const Vec3d> centers, const FluidMaterial& material = {},
                     const ObjectOptions& options = {});
  /// Fills a closed surface with fluid particles; see fill in geometry/fill.h.
  ObjectId add_fluid(const TriangleMesh& surface, const FluidMaterial& material = {},
                     const ObjectOptions& options = {});
  /// A rigid body in the shape of a mesh. It collides with rigid bodies and colliders as the convex hull of each
  /// connected piece, and with all other objects by its triangles. Its mass is that of the solid inside the mesh, or of
  /// the hulls if the mesh is not closed. Throws Error for a flat mesh.
  ObjectId add_rigid_body(const TriangleMesh& mesh, const RigidBodyMaterial& material = {},
                          const ObjectOptions& options = {});
  /// A rigid sphere, box, capsule or cylinder. Throws Error for other shapes.
  ObjectId add_rigid_body(const Shape& shape, const RigidBodyMaterial& material = {},
                          const ObjectOptions& options = {});
  /// A rigid body of several shapes, each of them a sphere, box, capsule or cylinder. Volume that shapes share counts
  /// in the mass of each. Throws Error without shapes.
  ObjectId add_rigid_body(std::span<const RigidPart> parts, const RigidBodyMaterial& material = {},
                          const ObjectOptions& options = {});
  /// Pose, velocity and mass of a rigid body. Throws Error for other objects.
  RigidBodyState rigid_body(ObjectId object) const;
  /// A kinematic body pushes others and is pushed by none: `move_body` or `set_motion` moves it. It has no energy and
  /// momentum. A body that becomes dynamic again keeps its current velocity.
  void set_kinematic(ObjectId body, bool kinematic);
  bool is_kinematic(ObjectId body) const;
  /// Moves a kinematic body so that its frame (RigidBodyState::pose) arrives at the pose at the end of the next step.
  /// It moves straight and turns at constant speed; without another call it then stays. Replaces its motion.
  void move_body(ObjectId body, const Transform& pose);
  /// Sets the velocity of the center of mass [m/s] and the angular velocity [rad/s] of a rigid body.
  void set_body_velocity(ObjectId body, const Vec3f& velocity, const Vec3f& angular_velocity);
  /// Adds a mesh with prescribed motion: static, driven by poses, or deforming. Other objects collide with it
  /// but cannot move it. It may be open or closed; both sides are solid. It has no mass, so its energies and
  /// momentum are 0. Throws if the options contain velocities, a stiffness_map or self_collision.
  ObjectId add_obstacle(const TriangleMesh& mesh, const ObstacleMaterial& material = {},
                        ObstacleMotion motion = {}, const ObjectOptions& options = {});
  void remove(ObjectId object);

  // --- joints of rigid bodies: objects/joint_options.h, rigid/joints/joint.h, docs/joints.md -------
  /// Joins two rigid bodies, or one to a collider or to the world ({}), as they lie now. From the next step on they do not
  /// collide with each other, unless the options say so or the joint breaks. Throws Error in the name of the joint.
  JointId add_joint(const JointSide& a, const JointSide& b, const joint::Kind& kind);
  JointId add_joint(const JointSide& a, const JointSide& b, const joint::Kind& kind,
                    const JointOptions& options);
  /// Joints of an object or collider are removed with it.
  void remove(JointId joint);
  /// Changes limits, springs, motors and all else of a joint, which stays of its kind.
  void set_joint(JointId joint, const joint::Kind& kind);
  const joint::Kind& joint_kind(JointId joint) const;
  JointReport joint_report(JointId joint) const;
  std::vector<JointId> joints() const;              ///< in order of addition
  JointId find_joint(std::string_view name) const;  ///< throws Error with the nearest name

  std::vector<ObjectId> objects() const;  ///< in order of addition
  bool contains(ObjectId object) const;
  ObjectId find_object(std::string_view name) const;  ///< throws Error with the nearest name
  const std::string& name(ObjectId object) const;
  ObjectKind kind(ObjectId object) const;
  /// The material must be of the object's kind; the spacing of a fluid cannot change.
  void set_material(ObjectId object, const Material& material);
  const Material& material(ObjectId object) const;
  const ClothMaterial& cloth_material(ObjectId object) const;
  const SoftBodyMaterial& soft_body_material(ObjectId object) const;
  const RopeMaterial& rope_material(ObjectId object) const;
  const GrainsMaterial& grains_material(ObjectId object) const;
  const ObstacleMaterial& obstacle_material(ObjectId object) const;
  const RigidBodyMaterial& rigid_body_material(ObjectId object) const;
  const FluidMaterial& fluid_material(ObjectId object) const;
  /// Bit masks as in ObjectOptions. Objects in contact that no longer collide pass through each other.
  /// Overlapping objects that start to collide are pushed apart slowly, or stay intersecting.
  void set_collision_groups(ObjectId object, std::uint32_t groups, std::uint32_t mask = ~0u);
  std::uint32_t collision_groups(ObjectId object) const;
  std::uint32_t collision_mask(ObjectId object) const;
  /// As in ObjectOptions. A pair of the object with itself may disable it (set_collide).
  SelfCollision self_collision(ObjectId object) const;
  /// As in ObjectOptions. Layer violations are resolved from the next step on.
  void set_layer(ObjectId object, int layer);
  int layer(ObjectId object) const;
  /// Sets the motion of an obstacle and moves it there at once. The jump gives it no velocity. A rigid body becomes
  /// kinematic, and `motion.pose` moves the body as it was added; a sequence does not apply.
  void set_motion(ObjectId object, ObstacleMotion motion);
  const ObstacleMotion& motion(ObjectId object) const;

  // Vertices in user order. A getter updates its data at the first call after a change. Addresses stay valid
  // until the object is removed. For a soft body made of a surface these are the surface's vertices.
  std::span<const Vec3f> positions(ObjectId object) const;   ///< m
  std::span<const Vec3f> velocities(ObjectId object) const;  ///< m/s
  /// The angular velocity of each grain about its center [rad/s]; empty for other kinds of objects.
  std::span<const Vec3f> angular_velocities(ObjectId object) const;
  /// Unit; empty without triangles: ropes, grains, fluids.
  std::span<const Vec3f> normals(ObjectId object) const;
  std::span<const Triangle> triangles(ObjectId object) const;
  /// The mesh as added (faces, UVs, groups), at its initial transform; empty for ropes, grains and fluids.
  const TriangleMesh& mesh(ObjectId object) const;
  double total_mass(ObjectId object) const;  ///< kg; 0 for obstacles
  /// Size of the tet mesh of a soft body; zeros for other kinds.
  struct TetStatistics {
    std::size_t tets = 0, particles = 0;
    double cell_size = 0;  ///< of the lattice that covers a surface [m]; 0 for a tet mesh
  };
  TetStatistics tet_statistics(ObjectId object) const;
  /// Pressure of each particle of a fluid, in user order: mean over the last step [Pa].
  std::vector<float> pressures(ObjectId fluid) const;
  /// Diffuse particles of all fluids whose material has `foam` > 0. They do not act on anything else.
  FoamView foam() const;
  /// Radius of grains and ropes, half the thickness of cloth, soft bodies and obstacles, half the spacing of
  /// fluids [m].
  float particle_radius(ObjectId object) const;

  /// These setters need an object whose vertices are particles; values are in user order. They throw for
  /// obstacles, and so do teleport, apply_impulse, pin and attach: only an obstacle's motion moves it. A kinematic rigid
  /// body has no set_velocities, apply_impulse, set_body_velocity either, and with a motion no teleport.
  void set_positions(ObjectId object, std::span<const Vec3f> positions);
  void set_velocities(ObjectId object, std::span<const Vec3f> velocities);
  /// Grains only; in user order [rad/s].
  void set_angular_velocities(ObjectId grains, std::span<const Vec3f> angular_velocities);
  /// Moves a whole object rigidly. The jump adds no velocity; existing velocities rotate with the object.
  void teleport(ObjectId object, const Transform& transform);
  /// Total impulse [N s], distributed over the selected vertices in proportion to their mass.
  void apply_impulse(ObjectId object, const Selector& selector, const Vec3f& impulse);
  /// Applies an impulse [N s] to a rigid body at a point of the world [m], inside the body or not. A force F during a
  /// step of dt is the impulse F dt. Throws for kinematic bodies and other objects.
  void apply_impulse(ObjectId body, const Vec3f& impulse, const Vec3f& point);
  /// An angular impulse on a rigid body [N m s]; a torque during a step of dt is torque dt.
  void apply_angular_impulse(ObjectId body, const Vec3f& impulse);

  /// The vertices that a selector selects: user order, ascending. Throws if there is none.
  std::vector<std::uint32_t> select(ObjectId object, const Selector& selector) const;

  // --- pins, attachments, other constraints ------------------------------------------------------
  /// Fixes vertices at their positions, or drives them along `target`. Forces do not move a pinned vertex.
  void pin(ObjectId object, const Selector& selector, Target target = {});
  void unpin(ObjectId object, const Selector& selector);
  std::vector<std::uint32_t> pinned(ObjectId object) const;
  /// Moves pinned vertices so that they arrive at the end of the next step, straight and at constant speed;
  /// without another call they then stay. Replaces their targets. `motion` is applied to the positions at
  /// which the vertices were pinned, about the world's origin: that of a bone since then. Its scale is ignored.
  /// Throws if a vertex is not pinned.
  void move_pins(ObjectId object, const Selector& selector, const Transform& motion);
  /// Moves the pinned vertex vertices[k] to positions[k] [m].
  void move_pins(ObjectId object, std::span<const std::uint32_t> vertices, std::span<const Vec3f> positions);
  /// Attaches vertices to a target (default: their current positions) by springs of compliance [m/N]; 0 is
  /// rigid.
  ProjectorId attach(ObjectId object, const Selector& selector, Target target = {}, float compliance = 0);
  /// Adds distance joints between pairs of vertices, with a rest length [m]; negative: their current
  /// distance. The first step that starts at or after the world time `until` [s] releases them; without
  /// `until` they stay.
  ProjectorId connect(std::span<const std::pair<VertexRef, VertexRef>> pairs, float rest_length = 0,
                      float compliance = 0, std::optional<double> until = {});
  /// Limits the distance of each vertex from the nearest pinned vertex to (1 + slack) times their rest
  /// distance along edges (Kim 2012).
  ProjectorId add_tethers(ObjectId object, float slack = 0.02f);

  // --- ties of any two objects: objects/tie_options.h, docs/attachments.md -------------------------
  /// Ties a point of a to a point of b. Each is cloth, a soft body, a rope, grains, a rigid body or an obstacle; b may
  /// also be a collider or the world ({}). Objects of a tie sleep together; they collide as before. Throws Error.
  TieId add_tie(const TieSide& a, const TieSide& b, const TieOptions& options);
  /// Ties each selected vertex of a to the closest point of b, if that is at most `distance` away [m]: a seam, a weld.
  /// Throws Error if there is none.
  std::vector<TieId> stitch(ObjectId a, const Selector& vertices, ObjectId b, double distance,
                            const TieOptions& options);
  /// Ties of an object or collider are removed with it.
  void remove(TieId tie);
  TieReport tie_report(TieId tie) const;
  std::vector<TieId> ties() const;  ///< in order of addition
  /// The point of an object's triangles, line or vertices that is closest to a point of the world [m].
  SurfacePoint surface_point(ObjectId object, const Vec3d& point) const;

  /// Sets the gas pressure inside a closed cloth, in Pa above the outside.
  void set_pressure(ObjectId object, float pascals);
  /// Keeps the enclosed volume of a closed cloth at `factor` times its rest volume; compliance in m^3/Pa (0:
  /// rigid).
  void set_enclosed_volume(ObjectId object, float factor, float compliance = 0);
  /// Adds any projector, e.g. a SetProjector<YourConstraint>. Its particle indices are those of `particle`.
  /// Throws if a particle does not exist.
  ProjectorId add_projector(std::unique_ptr<Projector> projector);
  void remove(ProjectorId projector);
  Projector& projector(ProjectorId projector);
  /// The particle index of a vertex, for user constraints. It changes when an object is removed; that of a
  /// fluid also when drains remove particles.
  std::uint32_t particle(ObjectId object, std::uint32_t vertex) const;
  /// The particles that move a vertex: the vertex's own particle, or the four corners of the lattice tet in
  /// which it is embedded. Their weights sum to 1; weights are negative for a vertex slightly outside its
  /// tet.
  std::vector<Carrier> carriers(ObjectId object, std::uint32_t vertex) const;

  // --- colliders, forces, events -----------------------------------------------------------------
  ColliderId add_collider(const Shape& shape, const ColliderOptions& options = {});
  void remove(ColliderId collider);
  void set_collider(ColliderId collider, const Shape& shape, const ColliderOptions& options);
  /// Moves a collider so that it arrives at the pose at the end of the next step. It translates and rotates at constant
  /// speed, so that it sweeps its path and pushes objects there. Without another call it then stays. Replaces its
  /// motion.
  void move_collider(ColliderId collider, const Transform& pose);
  std::vector<ColliderId> colliders() const;
  const Shape& shape(ColliderId collider) const;
  const ColliderOptions& collider_options(ColliderId collider) const;
  Transform collider_pose(ColliderId collider) const;  ///< at the current time
  ColliderId find_collider(std::string_view name) const;
  /// StepReport::fluid counts emitted and drained particles. Removing a fluid removes its emitters.
  EmitterId add_emitter(ObjectId fluid, const Emitter& emitter);
  /// The next layer leaves at `start`, or a whole number of layer intervals after it.
  void set_emitter(EmitterId id, const Emitter& emitter);
  void remove(EmitterId emitter);
  /// Removes particles of all fluids. The remaining particles keep their order and get new numbers.
  DrainId add_drain(const Drain& drain);
  void remove(DrainId drain);
  /// Leaves out particles of fluids inside a collider, or inside the closed surface of a soft or rigid body or an obstacle.
  /// Logs how many. It concerns what was added since the last step. A step does so before it begins, and build_world at
  /// its end. A closed surface that contains all of a fluid, or most of it, is a vessel.
  void leave_out_covered();
  /// Force of the pressure of all fluids on a collider: mean over the last step [N].
  Vec3d fluid_force(ColliderId collider) const;
  /// Overrides the combined material of two names (by default: geometric mean of frictions, larger
  /// restitution). `kinetic_friction`: at most `friction`; none: `friction`.
  void set_pair(std::string_view a, std::string_view b, float friction, float restitution,
                std::optional<float> kinetic_friction = {});
  /// Switches collision between two names on or off, in addition to their groups; on by default. With the
  /// same name twice, false disables self-collision of that object; true only revokes that. Picking and
  /// queries ignore this setting.
  void set_collide(std::string_view a, std::string_view b, bool collide);
  ForceFieldId add_force_field(ForceField field);
  ForceFieldId add_force_field(VertexForceField field);
  void remove(ForceFieldId field);
  void clear_force_fields();
  /// Contacts of the last step. The span is valid until the next step. It becomes empty when an object or
  /// collider is added, changed or removed.
  std::span<const ContactEvent> contacts() const;
  /// Tracks from the next step on which bodies touch; off by default, because it looks at the contacts of every
  /// substep. Sensors are always tracked.
  void track_contacts(bool on);
  /// The pairs of bodies that touched during the last step, or no longer do, sorted by object, then objects before
  /// colliders, then by handle. A pair touches if a contact between its bodies pushed in any substep; it persists
  /// while its bodies sleep. A body that was removed ends its pairs at the next step. Contacts of an object with
  /// itself are no pairs. After `restore` the next step compares with the pairs before it. Valid until the next step.
  std::span<const ContactPair> contact_pairs() const;
  /// A number that the world keeps for its user, 0 at first; snapshots do not have it.
  void set_user_data(ObjectId object, std::uint64_t data);
  void set_user_data(ColliderId collider, std::uint64_t data);
  std::uint64_t user_data(ObjectId object) const;
  std::uint64_t user_data(ColliderId collider) const;
  /// Wind of Settings::wind.
  void set_wind(const Wind& wind);
  /// Share of the wind's velocity that reaches an object, 0 (sheltered: still air) to 1, the default; more than
  /// 1 in a draft. Throws unless it is finite and at least 0.
  void set_wind_exposure(ObjectId object, float exposure);
  float wind_exposure(ObjectId object) const;
  /// Receives notes and warnings. A warning is logged once until a step passes without it; the report of each
  /// step has it.
  void set_log(std::function<void(LogLevel, std::string_view)> log);

  // --- sleeping, see Settings::sleeping ----------------------------------------------------------
  bool is_asleep(ObjectId object) const;
  /// Wakes an object's island. The rest time of an object that is awake restarts at 0.
  void wake(ObjectId object);

  // --- queries -----------------------------------------------------------------------------------
  // They see the surfaces of objects that have triangles, else balls of `particle_radius` around the vertices. The
  // first query after a change builds or refits hierarchies of boxes; docs/cpp-guide.md has the cost.

  /// The first hit. At equal distance the first object counts, then the lower triangle or vertex; colliders come last.
  /// A ray that starts in a ball or a collider hits it at once.
  Hit ray_cast(const Vec3f& origin, const Vec3f& direction, double max_distance = 1e30,
               const QueryFilter& filter = {}) const;
  /// All triangles, balls and colliders that the ray hits, in order of distance.
  std::vector<Hit> ray_cast_all(const Vec3f& origin, const Vec3f& direction, double max_distance = 1e30,
                                const QueryFilter& filter = {}) const;
  /// The first hit of a ball whose center moves along the ray. A surface that the ball touches at the start is hit at
  /// distance 0.
  Hit sphere_cast(const Vec3f& origin, float radius, const Vec3f& direction, double max_distance = 1e30,
                  const QueryFilter& filter = {}) const;
  Hit closest_point(const Vec3f& point, const QueryFilter& filter = {}) const;
  /// Objects, in order of addition, then colliders that a shape at a pose (of scale 1) overlaps. Surfaces count as
  /// surfaces: a shape inside a closed one overlaps nothing. Exact where a vertex or ball is in the shape; otherwise
  /// to a ten-thousandth of the shape's size.
  std::vector<Overlap> overlap(const Shape& shape, const Transform& pose = {},
                               const QueryFilter& filter = {}) const;
  /// Number of edges of an object that pass through its own triangles, for example because SelfCollision::particles
  /// lets them through. A search of its whole surface, some 30 ms for 20,000 triangles; 0 for objects without triangles
  /// of their own.
  std::size_t count_crossings(ObjectId object) const;
  double kinetic_energy(ObjectId object) const;    ///< with the rotation of grains and rigid bodies [J]
  double potential_energy(ObjectId object) const;  ///< of its weight; 0 at the origin [J]
  /// 1/2 C^T alpha^-1 C of all constraints with compliance > 0 [J].
  double elastic_energy() const;
  /// The part of elastic_energy that steps of dt can neither store nor return, because the solver does not converge. A
  /// spring stiffer than its sweeps acts as the softer spring that they make (docs/solvers.md, "Energy") [J].
  double unconverged_energy(double dt) const;
  Vec3d momentum(ObjectId object) const;        ///< kg m/s
  Vec3d center_of_mass(ObjectId object) const;  ///< m; for obstacles the mean of the vertices

  // --- for renderers -----------------------------------------------------------------------------
  /// Calls the callbacks of `draw` with internal data: constraints by kind and color in the order of the
  /// solver, contacts, particles, edges of tets. Changes nothing.
  void debug_draw(const DebugDraw& draw) const;

  // --- state -------------------------------------------------------------------------------------
  /// All state that a step changes. A world built the same way that restores it continues bitwise equal. Moves
  /// requested of pins and colliders for the next step are not part of it.
  Snapshot snapshot() const;
  /// Throws if the snapshot belongs to a world with other objects or is damaged; the world is then unchanged. Also
  /// after a step that threw: everything but the objects is then rebuilt.
  void restore(const Snapshot& snapshot);
  /// FNV-1a 64 over the bytes of all objects in order of name: positions, then velocities, in user order.
  std::uint64_t hash() const;
  /// Increases whenever positions or velocities may have changed; data computed from them is then out of
  /// date.
  std::uint64_t version() const;

  // --- profiling; all leave the particles unchanged ----------------------------------------------
  /// Projects the constraints of each kind alone, `sweeps` times, as in a substep of step(dt). Attachments
  /// and other user constraints form kinds of their own; contacts are excluded. Throws Error if a step could
  /// not run.
  std::vector<KindTime> time_projections(double dt, int sweeps);
  /// Solves one substep of step(dt) with `iterations` from the current positions, without forces and
  /// velocities. 0 iterations only measure the strain.
  SolveTime time_solve(double dt, int iterations);
  /// Current heap memory. After a step and a read of the positions this is the total need of a running scene.
  MemoryReport memory();

 private:
  struct Impl;
  /// Throws Error if the world was moved from.
  WorldState& state() const;
  WorldState& unfinished_state() const;  // objects that were removed may be there
  std::unique_ptr<Impl> impl_;
};

}  // namespace souple
