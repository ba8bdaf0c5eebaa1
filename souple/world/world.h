#pragma once

#include "souple/collision/collider_motion.h"
#include "souple/collision/shapes.h"
#include "souple/error.h"
#include "souple/fluid/foam_parameters.h"
#include "souple/geometry/lattice.h"
#include "souple/geometry/tet_mesh.h"
#include "souple/geometry/triangle_mesh.h"
#include "souple/math/transform.h"
#include "souple/solver/projector.h"
#include "souple/world/debug_draw.h"
#include "souple/world/emitter.h"
#include "souple/world/materials.h"
#include "souple/world/memory.h"
#include "souple/world/obstacle_motion.h"
#include "souple/world/profile.h"
#include "souple/world/report.h"
#include "souple/world/selector.h"
#include "souple/world/settings.h"

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

/// A stable handle; stays valid until the object is removed, and is never reused for another.
struct ObjectId {
  std::uint32_t value = 0;
  friend bool operator==(const ObjectId&, const ObjectId&) = default;
};
struct ColliderId {
  std::uint32_t value = 0;
  friend bool operator==(const ColliderId&, const ColliderId&) = default;
};
struct ProjectorId {
  std::uint32_t value = 0;
};

enum class ObjectKind { cloth, soft_body, rope, grains, obstacle, fluid };
std::string_view kind_name(ObjectKind kind);

/// What all objects can be given when they are added.
struct ObjectOptions {
  std::string name{};        ///< unique; empty: the kind, then kind2, kind3, ...
  Transform transform{};     ///< applied to the mesh
  Vec3f velocity{};          ///< m/s
  Vec3f angular_velocity{};  ///< rad/s about the center of mass
  /// Per vertex, scales stiffness (mean over a constraint's vertices); empty: 1.
  std::vector<float> stiffness_map{};
  std::vector<float> thickness_map{};  ///< per vertex, scales thickness; empty: 1
  /// Its surface touches itself: cloth folds over itself, a rope cannot pass through itself.
  bool self_collision = false;
  /// Which layer of cloth its surface is, from 0 to 1000. Of two objects that meet, the one of the higher
  /// layer lies over the other, on the side where the lower one's triangles are counter-clockwise, and comes
  /// out where it is put wrong. 0: in no order with others. Of objects with a surface of their own: cloth,
  /// soft bodies from tets, obstacles.
  int layer = 0;
  /// Of a fluid: emitters give it no more than these, for which there is room from the start; 0: it stays as
  /// it is. With room a fluid may begin without any.
  std::uint32_t max_particles = 0;
  /// Bit masks: which of 32 groups it belongs to, and which groups it wants to meet. Two things meet when
  /// a.collision_groups & b.collision_mask and b.collision_groups & a.collision_mask are both non-zero.
  std::uint32_t collision_groups = 1;
  std::uint32_t collision_mask = ~0u;
};

struct ColliderOptions {
  float friction = 0.5f;
  float restitution = 0;
  std::string name{};                  ///< unique; empty: collider, collider2, ...
  ColliderMotion motion{};             ///< static unless told otherwise; poses are applied to the shape
  std::uint32_t collision_groups = 1;  ///< as of objects
  std::uint32_t collision_mask = ~0u;
};

/// Where a pinned or attached vertex has to be: (vertex in user order, time in s) -> meters.
using Target = std::function<Vec3d(std::uint32_t vertex, double time)>;

/// A force field: (position [m], velocity [m/s], mass [kg], time [s]) -> force [N].
using ForceField = std::function<Vec3f(const Vec3f&, const Vec3f&, float, double)>;

/// One vertex of one object.
struct VertexRef {
  ObjectId object;
  std::uint32_t vertex = 0;
};

/// A particle that carries a vertex, and its share in the vertex' position.
struct Carrier {
  std::uint32_t particle = 0;
  double weight = 1;
  float inverse_mass = 0;  ///< 1/kg; 0: it is pinned
  Vec3d position{};        ///< m
};

/// What a ray or a closest-point query found.
struct Hit {
  bool found = false;
  ObjectId object{};  ///< meaningful when `collider` is not
  ColliderId collider{};
  bool is_collider = false;
  std::uint32_t vertex = 0;    ///< of the object, the one nearest to the point, user order
  std::uint32_t triangle = 0;  ///< of the object's surface, when it has one
  Vec3f point{};               ///< m
  double distance = 0;         ///< from the ray's origin, or from the query point [m]
};

/// A contact that pushed during the last substep of a step.
struct ContactEvent {
  std::string_view object, other;  ///< names; other is a collider or an object
  std::uint32_t vertex = 0, other_vertex = 0;
  bool other_is_collider = true;
  Vec3f point{}, normal{};  ///< normal points to `object`
  float impulse = 0;        ///< N s
};

/// Spray, foam and bubbles of all fluids, in no order that stays. What it looks at is valid until the next
/// step.
struct FoamView {
  std::span<const Vec3f> positions;   ///< m
  std::span<const Vec3f> velocities;  ///< m/s
  std::span<const FoamKind> kinds;
};

/// Everything that moves, as bytes; see World::snapshot.
struct Snapshot {
  std::vector<std::byte> bytes;
};

enum class LogLevel { info, warning, error };

/// Objects, colliders and the loop that moves them. Meters, kilograms, seconds; Y up, right-handed.
///
/// All functions but `step` throw Error on bad arguments and then leave the world as it was. `step` never
/// throws. Not thread-safe: one thread at a time.
class World {
 public:
  explicit World(const Settings& settings = {});
  ~World();
  World(World&&) noexcept;
  World& operator=(World&&) noexcept;

  // --- the loop ----------------------------------------------------------------------------------
  /// Advances by dt seconds in `substeps` equal parts.
  const StepReport& step(double dt);
  const StepReport& report() const;
  double time() const;  ///< s
  const Settings& settings() const;
  void set_settings(const Settings& settings);
  /// Runs before or after a stage, each time it runs. An exception in it is caught and reported.
  void before(Stage stage, std::function<void(World&)> callback);
  void after(Stage stage, std::function<void(World&)> callback);

  // --- objects -----------------------------------------------------------------------------------
  ObjectId add_cloth(const TriangleMesh& mesh, const ClothMaterial& material = {},
                     const ObjectOptions& options = {});
  ObjectId add_soft_body(const TetMesh& mesh, const SoftBodyMaterial& material = {},
                         const ObjectOptions& options = {});
  /// From any closed surface: a lattice of tets (about 2000 unless told otherwise) covers it, the surface is
  /// embedded and is what users see.
  ObjectId add_soft_body(const TriangleMesh& surface, const SoftBodyMaterial& material = {},
                         const LatticeOptions& lattice = {}, const ObjectOptions& options = {});
  /// Along the polyline `points` [m], cut into `segments` of equal length.
  ObjectId add_rope(std::span<const Vec3d> points, std::uint32_t segments, const RopeMaterial& material = {},
                    const ObjectOptions& options = {});
  ObjectId add_grains(std::span<const Vec3d> centers, const GrainsMaterial& material = {},
                      const ObjectOptions& options = {});
  /// Particles about `spacing` apart. Of the options, maps and self_collision make no sense.
  ObjectId add_fluid(std::span<const Vec3d> centers, const FluidMaterial& material = {},
                     const ObjectOptions& options = {});
  /// Fills a closed surface with particles; see fill in geometry/fill.h.
  ObjectId add_fluid(const TriangleMesh& surface, const FluidMaterial& material = {},
                     const ObjectOptions& options = {});
  /// A mesh that others touch and that goes where its motion says, whatever pushes at it: static, led through
  /// poses, or deforming. Open or closed; both sides are solid. It has no mass, so its energies and momentum
  /// are 0. Of the options, velocities, stiffness_map and self_collision make no sense.
  ObjectId add_obstacle(const TriangleMesh& mesh, const ObstacleMaterial& material = {},
                        ObstacleMotion motion = {}, const ObjectOptions& options = {});
  void remove(ObjectId object);

  std::vector<ObjectId> objects() const;  ///< in the order they were added
  bool contains(ObjectId object) const;
  ObjectId find_object(std::string_view name) const;  ///< throws with the nearest name
  const std::string& name(ObjectId object) const;
  ObjectKind kind(ObjectId object) const;
  void set_material(ObjectId object, const ClothMaterial& material);
  void set_material(ObjectId object, const SoftBodyMaterial& material);
  void set_material(ObjectId object, const RopeMaterial& material);
  void set_material(ObjectId object, const GrainsMaterial& material);
  void set_material(ObjectId object, const ObstacleMaterial& material);
  void set_material(ObjectId object, const FluidMaterial& material);  ///< its spacing has to stay
  const ClothMaterial& cloth_material(ObjectId object) const;
  const SoftBodyMaterial& soft_body_material(ObjectId object) const;
  const RopeMaterial& rope_material(ObjectId object) const;
  const GrainsMaterial& grains_material(ObjectId object) const;
  const ObstacleMaterial& obstacle_material(ObjectId object) const;
  const FluidMaterial& fluid_material(ObjectId object) const;
  /// Bit masks, as in ObjectOptions. What is in touch then and no longer meets passes through; what meets
  /// again while it overlaps is pushed out slowly, or stays tangled.
  void set_collision_groups(ObjectId object, std::uint32_t groups, std::uint32_t mask = ~0u);
  std::uint32_t collision_groups(ObjectId object) const;
  std::uint32_t collision_mask(ObjectId object) const;
  /// As in ObjectOptions. What lies wrong then comes out from the next step on.
  void set_layer(ObjectId object, int layer);
  int layer(ObjectId object) const;
  /// Of an obstacle. It is at once where the new motion says, without the velocity of the jump.
  void set_motion(ObjectId object, ObstacleMotion motion);
  const ObstacleMotion& motion(ObjectId object) const;

  // What a user sees, in user order. Refreshed once per step when first asked; addresses stay until the
  // object is removed. For a soft body made from a surface these are the surface's vertices.
  std::span<const Vec3f> positions(ObjectId object) const;   ///< m
  std::span<const Vec3f> velocities(ObjectId object) const;  ///< m/s
  std::span<const Vec3f> normals(ObjectId object) const;     ///< unit; empty for ropes and grains
  std::span<const Triangle> triangles(ObjectId object) const;
  /// The mesh as it was given (faces, UVs, groups), placed at rest by its transform; empty for ropes and
  /// grains.
  const TriangleMesh& mesh(ObjectId object) const;
  double total_mass(ObjectId object) const;  ///< kg; 0 of an obstacle
  /// Of each particle of a fluid, user order, mean of the last step. [Pa]
  std::vector<float> pressures(ObjectId fluid) const;
  /// What the fluids have made whose material's `foam` is above 0. It does nothing to anything.
  FoamView foam() const;
  /// Of grains and ropes, half the thickness of the others, half the spacing of fluids. [m]
  float particle_radius(ObjectId object) const;

  /// For objects whose vertices are particles. User order. Obstacles go where their motion says: neither
  /// these nor teleport, apply_impulse, pins and attachments are for them.
  void set_positions(ObjectId object, std::span<const Vec3f> positions);
  void set_velocities(ObjectId object, std::span<const Vec3f> velocities);
  /// Moves a whole object rigidly without giving it the velocity of the jump; its velocities turn with it.
  void teleport(ObjectId object, const Transform& transform);
  /// Total impulse [N s], shared by the selected vertices in proportion to their mass.
  void apply_impulse(ObjectId object, const Selector& selector, const Vec3f& impulse);

  /// Which vertices a selector means, user order, ascending. Throws when it means none.
  std::vector<std::uint32_t> select(ObjectId object, const Selector& selector) const;

  // --- pins, attachments, other constraints ------------------------------------------------------
  /// Fixes vertices where they are, or drives them along `target`. A pinned vertex ignores every force.
  void pin(ObjectId object, const Selector& selector, Target target = {});
  void unpin(ObjectId object, const Selector& selector);
  std::vector<std::uint32_t> pinned(ObjectId object) const;
  /// Pulls vertices to a target (default: where they are) with a spring of compliance [m/N]; 0 is rigid.
  ProjectorId attach(ObjectId object, const Selector& selector, Target target = {}, float compliance = 0);
  /// Ties pairs of vertices together at a rest length [m]; negative: the distance they have now. They are let
  /// go of by the first step that begins at or after `until` [s], by the world's time; never, if not given.
  ProjectorId connect(std::span<const std::pair<VertexRef, VertexRef>> pairs, float rest_length = 0,
                      float compliance = 0, std::optional<double> until = {});
  /// Keeps every vertex within (1 + slack) times its rest distance along edges from the nearest pinned vertex
  /// (Kim 2012).
  ProjectorId add_tethers(ObjectId object, float slack = 0.02f);
  /// Gas inside a closed cloth: pressure in Pa above the outside, until changed.
  void set_pressure(ObjectId object, float pascals);
  /// Keeps the volume a closed cloth encloses at `factor` times its rest volume; compliance in m^3/Pa (0
  /// rigid).
  void set_enclosed_volume(ObjectId object, float factor, float compliance = 0);
  /// Any projector, e.g. a SetProjector<YourConstraint>; particles are named by `particle`. Throws when it
  /// names one that does not exist.
  ProjectorId add_projector(std::unique_ptr<Projector> projector);
  void remove(ProjectorId projector);
  Projector& projector(ProjectorId projector);
  /// The particle index of a vertex, for constraints of one's own. Changes when objects are removed; that of
  /// a fluid also when drains take some.
  std::uint32_t particle(ObjectId object, std::uint32_t vertex) const;
  /// The same for any vertex: one particle, or the four of the lattice's tet in which it is embedded. Weights
  /// sum up to 1; they are negative where the vertex lies a little outside its tet.
  std::vector<Carrier> carriers(ObjectId object, std::uint32_t vertex) const;

  // --- colliders, forces, events -----------------------------------------------------------------
  ColliderId add_collider(const Shape& shape, const ColliderOptions& options = {});
  void remove(ColliderId collider);
  void set_collider(ColliderId collider, const Shape& shape, const ColliderOptions& options);
  std::vector<ColliderId> colliders() const;
  const Shape& shape(ColliderId collider) const;
  const ColliderOptions& collider_options(ColliderId collider) const;
  Transform collider_pose(ColliderId collider) const;  ///< now
  ColliderId find_collider(std::string_view name) const;
  /// What emitters and drains do is told by StepReport::fluid. A fluid's emitters go with it.
  EmitterId add_emitter(ObjectId fluid, const Emitter& emitter);
  void set_emitter(EmitterId id,
                   const Emitter& emitter);  ///< its first layer comes at once, or when it starts
  void remove(EmitterId emitter);
  /// Takes particles of all fluids. Those that stay keep their order and are numbered anew.
  DrainId add_drain(const Drain& drain);
  void remove(DrainId drain);
  /// With which the pressure of all fluids pushes a collider, mean of the last step. [N]
  Vec3d fluid_force(ColliderId collider) const;
  /// Overrides the pair rules (geometric mean of frictions, larger restitution) for two names.
  void set_pair(std::string_view a, std::string_view b, float friction, float restitution);
  /// Whether two things collide at all, whatever their groups say; they do until told otherwise. The name of
  /// an object twice: false stops it from colliding with itself, true only takes that back. Picking and
  /// queries find everything all the same.
  void set_collide(std::string_view a, std::string_view b, bool collide);
  void add_force_field(ForceField field);
  void clear_force_fields();
  /// Contacts of the last step; valid until the next, or until an object or collider is added, changed or
  /// removed: there are none then.
  std::span<const ContactEvent> contacts() const;
  void set_log(std::function<void(LogLevel, std::string_view)> log);

  // --- sleeping, see Settings::sleeping ----------------------------------------------------------
  bool is_asleep(ObjectId object) const;
  /// Wakes an object and all that sleep in touch with it; one that is awake begins its rest anew.
  void wake(ObjectId object);

  // --- queries -----------------------------------------------------------------------------------
  Hit ray_cast(const Vec3f& origin, const Vec3f& direction, double max_distance = 1e30) const;
  Hit closest_point(const Vec3f& point) const;
  double kinetic_energy(ObjectId object) const;    ///< J
  double potential_energy(ObjectId object) const;  ///< of its weight, 0 at the origin [J]
  double elastic_energy() const;                   ///< of all constraints with compliance > 0 [J]
  Vec3d momentum(ObjectId object) const;           ///< kg m/s
  Vec3d center_of_mass(ObjectId object) const;     ///< m; of an obstacle the mean of its vertices

  // --- for renderers -----------------------------------------------------------------------------
  /// Hands out what is inside: constraints kind after kind and color after color, in the order in which
  /// they are solved, contacts, particles, edges of tets. Changes nothing.
  void debug_draw(const DebugDraw& draw) const;

  // --- state -------------------------------------------------------------------------------------
  /// Everything a step changes. Restoring into a world built the same way continues bitwise the same.
  Snapshot snapshot() const;
  /// Throws when the snapshot is of a world with other objects or is damaged; then nothing has changed.
  void restore(const Snapshot& snapshot);
  /// FNV-1a 64 over the bytes of user-order positions, then velocities, of every object in order of name.
  std::uint64_t hash() const;
  /// Grows whenever positions or velocities may have changed: what was made from them is out of date.
  std::uint64_t version() const;

  // --- measuring; all leave every particle as it was ---------------------------------------------
  /// Projects the constraints of each kind alone, `sweeps` times, as a substep of step(dt) would. Attachments
  /// and the like are kinds of their own; contacts are left out. Throws Error as for a step that cannot be
  /// done.
  std::vector<KindTime> time_projections(double dt, int sweeps);
  /// Solves one substep of step(dt) with `iterations` from where the particles are: no forces, no velocities.
  /// 0 iterations only look.
  SolveTime time_solve(double dt, int iterations);
  /// What is held on the heap now: after a step and a look at the positions, all that a running scene needs.
  MemoryReport memory();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace souple
