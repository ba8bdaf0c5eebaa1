#include "souple/world/world.h"

#include "souple/fluid/stage/fluid_foam.h"
#include "souple/fluid/stage/fluids.h"
#include "souple/geometry/measures.h"
#include "souple/math/elementary.h"
#include "souple/objects/checks.h"
#include "souple/objects/collider_record.h"
#include "souple/objects/kind_functions.h"
#include "souple/objects/new_object.h"
#include "souple/objects/object.h"
#include "souple/objects/obstacle_pose.h"
#include "souple/queries/nearest_name.h"
#include "souple/simd/instruction_set.h"
#include "souple/world/add.h"
#include "souple/world/arrivals.h"
#include "souple/world/build.h"
#include "souple/world/call_scope.h"
#include "souple/world/callbacks.h"
#include "souple/world/contact_state.h"
#include "souple/world/contacts.h"
#include "souple/world/impl.h"
#include "souple/world/joints/joints.h"
#include "souple/world/joints/ties.h"
#include "souple/world/prepare.h"
#include "souple/world/recover.h"
#include "souple/world/registry.h"
#include "souple/world/removal.h"
#include "souple/world/rigid_bodies.h"
#include "souple/world/sleeping.h"
#include "souple/world/validate.h"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>

namespace souple {

World::World(const Settings& settings) : impl_(std::make_unique<Impl>()) {
  set_settings(settings);
}
World::~World() = default;
World::World(World&&) noexcept = default;
World& World::operator=(World&&) noexcept = default;

WorldState& World::unfinished_state() const {
  if (!impl_) throw Error("the world was moved from: it can only be assigned to or destroyed");
  return impl_->state;
}

WorldState& World::state() const {
  WorldState& world = unfinished_state();
  if (world.registry->removals.pending.load(std::memory_order_acquire)) finish_removals(world);
  return world;
}

const StepReport& World::report() const {
  return state().report;
}
double World::time() const {
  return state().time;
}
const Settings& World::settings() const {
  return state().settings;
}

void World::set_settings(const Settings& settings) {
  validate(settings);
  thread_count(settings.threads);  // throws here, not in a step, if SOUPLE_THREADS is no number
  instruction_set();               // or if SOUPLE_SIMD is no instruction set
  WorldState& world = state();
  const CallScope call(*world.calls, "set_settings");
  if (settings.threads != world.settings.threads || settings.threading != world.settings.threading)
    world.threads.reset();
  const Settings& old = world.settings;
  const bool same = settings.solver == old.solver && settings.mode == old.mode;
  world.dirty.solver = world.dirty.solver || !same;  // building a hierarchy takes a while
  if (!(settings.gravity == old.gravity && settings.wind == old.wind && settings.drag == old.drag &&
        settings.sleeping == old.sleeping))
    wake_all(world);
  world.settings = settings;
}

void World::prepare() {
  WorldState& world = state();
  const CallScope call(*world.calls, "prepare");
  bring_up_to_date(world);
}

namespace {

/// Adds a callback to the list of its stage, for the function `what`.
template <class Lists>
CallbackId add_callback(WorldState& world, Lists& lists, Stage stage, std::function<void(World&)> callback,
                        const char* what) {
  const CallScope call(*world.calls, what, From::stages);
  check_all(what, {{"stage", double(stage), 0, double(stage_count - 1)}});
  if (!callback) throw Error(std::string(what) + ": the function is empty");
  lists[static_cast<std::size_t>(stage)].add(world.callbacks->next_id, std::move(callback));
  return {world.callbacks->next_id++};
}

}  // namespace

CallbackId World::before(Stage stage, std::function<void(World&)> callback) {
  return add_callback(state(), state().callbacks->before, stage, std::move(callback), "before");
}

CallbackId World::after(Stage stage, std::function<void(World&)> callback) {
  return add_callback(state(), state().callbacks->after, stage, std::move(callback), "after");
}

void World::remove(CallbackId id) {
  WorldState& world = state();
  const CallScope call(*world.calls, "remove(CallbackId)", From::stages);
  bool found = false;
  for (auto* lists : {&world.callbacks->before, &world.callbacks->after})
    for (auto& callbacks : *lists) found = found || callbacks.remove(id.value);
  if (!found) throw_stale("callback", id.value);
  if (!world.current.running) world.callbacks->erase_removed();
}

// --- objects -------------------------------------------------------------------------------------

void World::remove(ObjectId id) {
  WorldState& world = unfinished_state();
  const CallScope call(*world.calls, "remove(ObjectId)");
  if (!contains_object(world, id)) throw_stale("object", id.value);
  remove_later(world, id);
}

std::vector<ObjectId> World::objects() const {
  std::vector<ObjectId> ids;
  for (const auto& object : state().objects) ids.push_back(object->id);
  return ids;
}

bool World::contains(ObjectId id) const {
  return contains_object(unfinished_state(), id);
}

ObjectId World::find_object(std::string_view name) const {
  const NameRegistry::Entry* const entry = state().registry->names.find(name);
  if (entry != nullptr && entry->owner == NameRegistry::Owner::object) return {entry->id};
  std::vector<std::string_view> names;
  for (const auto& object : state().objects) names.push_back(object->name);
  throw Error("no object is named '" + std::string(name) + "'" + nearest_name(name, names));
}

const std::string& World::name(ObjectId id) const {
  return state().object(id).name;
}
ObjectKind World::kind(ObjectId id) const {
  return state().object(id).kind;
}

namespace {

void require_obstacle(const Object& object, const char* what) {
  if (!object.traits().driven)
    throw Error(std::string(what) + ": " + object.name + " is a " + std::string(kind_name(object.kind)) +
                ", expected an obstacle");
}

[[noreturn]] void refuse_kind(const Object& object) {
  throw Error(object.name + " is a " + std::string(kind_name(object.kind)) +
              ": it has no material of the requested kind");
}

template <class M>
const M& material_of(const WorldState& world, ObjectId id) {
  const Object& object = world.object(id);
  if (const M* material = std::get_if<M>(&object.material)) return *material;
  refuse_kind(object);
}

}  // namespace

void World::set_material(ObjectId id, const Material& material) {
  WorldState& world = state();
  const CallScope call(*world.calls, "set_material");
  Object& object = world.object(id);
  if (kind_of(material) != object.kind) refuse_kind(object);
  const KindFunctions& kind = functions_of(object.kind);
  if (kind.validate_change) kind.validate_change(object.material, material, object.name);
  kind.validate(material, object.name);
  replace_material(world, object, material);
  ++world.version;  // the radius of balls, for queries
}
const Material& World::material(ObjectId id) const {
  return state().object(id).material;
}
const ClothMaterial& World::cloth_material(ObjectId id) const {
  return material_of<ClothMaterial>(state(), id);
}
const SoftBodyMaterial& World::soft_body_material(ObjectId id) const {
  return material_of<SoftBodyMaterial>(state(), id);
}
const RopeMaterial& World::rope_material(ObjectId id) const {
  return material_of<RopeMaterial>(state(), id);
}
const GrainsMaterial& World::grains_material(ObjectId id) const {
  return material_of<GrainsMaterial>(state(), id);
}
const FluidMaterial& World::fluid_material(ObjectId id) const {
  return material_of<FluidMaterial>(state(), id);
}
const RigidBodyMaterial& World::rigid_body_material(ObjectId id) const {
  return material_of<RigidBodyMaterial>(state(), id);
}

const ObstacleMaterial& World::obstacle_material(ObjectId id) const {
  return material_of<ObstacleMaterial>(state(), id);
}

void World::set_collision_groups(ObjectId id, std::uint32_t groups, std::uint32_t mask) {
  WorldState& world = state();
  const CallScope call(*world.calls, "set_collision_groups");
  world.object(id).collision.filter = {groups, mask};
  world.dirty.tables = true;
  wake_all(world);
}
std::uint32_t World::collision_groups(ObjectId id) const {
  return state().object(id).collision.filter.groups;
}
std::uint32_t World::collision_mask(ObjectId id) const {
  return state().object(id).collision.filter.mask;
}

SelfCollision World::self_collision(ObjectId id) const {
  return state().object(id).collision.itself;
}

void World::set_layer(ObjectId id, int layer) {
  WorldState& world = state();
  const CallScope call(*world.calls, "set_layer");
  Object& object = world.object(id);
  require_layer(object, layer);
  object.collision.layer = layer;
  world.dirty.tables = true;
  wake_all(world);
}
int World::layer(ObjectId id) const {
  return state().object(id).collision.layer;
}

void World::set_motion(ObjectId id, ObstacleMotion motion) {
  WorldState& world = state();
  const CallScope call(*world.calls, "set_motion");
  Object& object = world.object(id);
  if (object.traits().rigid) return set_body_motion(world, object, std::move(motion));
  require_obstacle(object, "set_motion");
  validate(motion, object.vertex_count(), object.name);
  std::swap<ObstacleMotion>(object.motion, motion);
  std::vector<Vec3d> now;
  try {
    now = obstacle_positions(object, world.time);
  } catch (...) {
    static_cast<ObstacleMotion&>(object.motion) = std::move(motion);
    throw;
  }
  for (std::uint32_t k = 0; k < object.particle_count(); ++k) {
    world.teleport_particle(object.begin + k, now[k]);
    world.particles.velocity[object.begin + k] = {};
  }
  world.dirty.tables = world.dirty.tables || deforms(motion) != deforms(object.motion);
  wake_all(world);
  world.contact->invalidate();
  ++world.version;
}

const ObstacleMotion& World::motion(ObjectId id) const {
  const Object& object = state().object(id);
  if (!object.traits().rigid) require_obstacle(object, "motion");
  return object.motion;
}

std::span<const Triangle> World::triangles(ObjectId id) const {
  return state().object(id).mesh.triangles;
}

World::TetStatistics World::tet_statistics(ObjectId id) const {
  const Object& object = state().object(id);
  TetStatistics statistics{object.tets.tets.size(), object.tets.positions.size(), 0};
  // A cube of the lattice has the volume of twelve of its tets.
  if (object.embedding && !object.tets.tets.empty())
    statistics.cell_size =
        elementary::cbrt(12 * tet_volume(object.tets) / static_cast<double>(statistics.tets));
  return statistics;
}

const TriangleMesh& World::mesh(ObjectId id) const {
  return state().object(id).mesh;
}

double World::total_mass(ObjectId id) const {
  const Object& object = state().object(id);
  double sum = 0;
  for (std::uint32_t i = object.begin; i < object.end; ++i)
    sum += static_cast<double>(state().particles.mass[i]);
  return sum;
}

std::vector<float> World::pressures(ObjectId id) const {
  require_readable(*state().calls, "pressures");
  require_whole(*state().calls, "pressures");
  material_of<FluidMaterial>(state(), id);
  const Object& object = state().object(id);
  std::vector<float> result;
  for (const std::uint32_t particle : object.particle_of)
    result.push_back(state().fluids->pressure(object.begin + particle));
  return result;
}

FoamView World::foam() const {
  require_readable(*state().calls, "foam");
  require_whole(*state().calls, "foam");
  const FluidFoam& foam = state().fluids->foam();
  return {foam.positions(), foam.velocities(), foam.kinds()};
}

float World::particle_radius(ObjectId id) const {
  return souple::particle_radius(state().object(id).material);
}

namespace {

void require_particle_vertices(const Object& object, const char* what) {
  if (object.embedding)
    throw Error(std::string(what) + ": the vertices of " + object.name +
                " are embedded in a lattice, not particles; use teleport, apply_impulse, pin or attach");
}

void require_count(const Object& object, std::size_t count, const char* what) {
  if (count != object.vertex_count())
    throw Error(fmt::format("{}: {} has {} vertices, got {} values", what, object.name, object.vertex_count(),
                            count));
}

void require_all_within(const Object& object, std::span<const Vec3f> values, double limit, const char* what) {
  for (std::size_t i = 0; i < values.size(); ++i)
    if (!is_within(values[i], limit))
      throw Error(fmt::format("{}: {}, value {} is not finite or beyond {:g}", what, object.name, i, limit));
}

/// Throws unless each of the object's vertices can be set to one of these values.
void require_settable(const Object& object, std::span<const Vec3f> values, double limit, const char* what) {
  require_movable(object, what);
  require_particle_vertices(object, what);
  require_count(object, values.size(), what);
  require_all_within(object, values, limit, what);
}

}  // namespace

void World::set_positions(ObjectId id, std::span<const Vec3f> positions) {
  WorldState& world = state();
  const CallScope call(*world.calls, "set_positions", From::stages);
  const Object& object = world.object(id);
  if (object.traits().rigid)
    throw Error("set_positions: " + object.name +
                " is a rigid body, whose vertices do not move alone; use teleport");
  require_settable(object, positions, range::coordinate, "set_positions");
  wake_island(world, object);
  for (std::uint32_t i = object.begin; i < object.end; ++i) {
    world.particles.position[i].set_xyz(positions[object.vertex_of[i - object.begin]]);
    world.particles.offset[i] = {};
  }
  world.contact->check_intersections = true;
  ++world.version;
}

void World::set_velocities(ObjectId id, std::span<const Vec3f> velocities) {
  WorldState& world = state();
  const CallScope call(*world.calls, "set_velocities", From::stages);
  const Object& object = world.object(id);
  require_settable(object, velocities, range::speed, "set_velocities");
  require_dynamic(object, "set_velocities");
  wake_island(world, object);
  for (std::uint32_t i = object.begin; i < object.end; ++i)
    world.particles.velocity[i].set_xyz(velocities[object.vertex_of[i - object.begin]]);
  ++world.version;
}

void World::set_angular_velocities(ObjectId id, std::span<const Vec3f> angular_velocities) {
  WorldState& world = state();
  const CallScope call(*world.calls, "set_angular_velocities", From::stages);
  const Object& object = world.object(id);
  if (!object.traits().rolls)
    throw Error(
        fmt::format("set_angular_velocities: {} is not made of grains, which alone have angular velocities",
                    object.name));
  require_settable(object, angular_velocities, range::speed, "set_angular_velocities");
  wake_island(world, object);
  for (std::uint32_t i = object.begin; i < object.end; ++i)
    if (world.particles.position[i].w > 0)
      world.particles.spin[i].set_xyz(angular_velocities[object.vertex_of[i - object.begin]]);
  ++world.version;
}

void World::teleport(ObjectId id, const Transform& transform) {
  WorldState& world = state();
  const CallScope call(*world.calls, "teleport", From::stages);
  const Object& object = world.object(id);
  require_movable(object, "teleport");
  require_no_motion(object, "teleport");
  validate(transform, "teleport");
  if (transform.scale != 1)
    throw Error(fmt::format("teleport: the scale is {}, expected 1", transform.scale));
  for (std::uint32_t i = object.begin; i < object.end; ++i)
    if (!is_within(transform.point(world.particles.exact_position(i)), range::coordinate))
      throw Error(fmt::format("teleport: {} would be more than {:g} m from the origin", object.name,
                              range::coordinate));
  wake_island(world, object);
  if (object.traits().rigid) teleport_body(world, object, transform);
  const bool rolls = object.traits().rolls;
  for (std::uint32_t i = object.begin; i < object.end; ++i) {
    const Vec3d x = world.particles.exact_position(i);
    world.teleport_particle(i, transform.point(x));
    Vec4f& velocity = world.particles.velocity[i];
    velocity.set_xyz(Vec3f(transform.direction(Vec3d(velocity.xyz()))));
    if (!rolls) continue;
    Vec4f& spin = world.particles.spin[i];
    spin.set_xyz(Vec3f(transform.direction(Vec3d(spin.xyz()))));
  }
  ++world.version;
}

void World::apply_impulse(ObjectId id, const Selector& selector, const Vec3f& impulse) {
  WorldState& world = state();
  const CallScope call(*world.calls, "apply_impulse", From::stages);
  const Object& object = world.object(id);
  require_movable(object, "apply_impulse");
  require_dynamic(object, "apply_impulse");
  if (!is_finite(impulse)) throw Error("apply_impulse: the impulse on " + object.name + " is not finite");
  const std::vector<std::uint32_t> chosen = particles_of(object, select(id, selector));
  wake_island(world, object);
  double mass = 0;
  for (const std::uint32_t i : chosen)
    if (world.particles.position[object.begin + i].w > 0)
      mass += static_cast<double>(world.particles.mass[object.begin + i]);
  if (!(mass > 0)) return;  // all particles are pinned
  const Vec3f dv = impulse / static_cast<float>(mass);
  for (const std::uint32_t i : chosen) {
    Vec4f& velocity = world.particles.velocity[object.begin + i];
    if (world.particles.position[object.begin + i].w > 0) velocity.set_xyz(velocity.xyz() + dv);
  }
  ++world.version;
}

namespace {

void require_vertex(const Object& object, std::uint32_t vertex, const char* what) {
  if (vertex >= object.vertex_count())
    throw Error(fmt::format("{}: {} has {} vertices, but no vertex {}", what, object.name,
                            object.vertex_count(), vertex));
}

}  // namespace

std::uint32_t World::particle(ObjectId id, std::uint32_t vertex) const {
  const Object& object = state().object(id);
  require_particle_vertices(object, "particle");
  require_vertex(object, vertex, "particle");
  return object.begin + object.particle_of[vertex];
}

std::vector<Carrier> World::carriers(ObjectId id, std::uint32_t vertex) const {
  const Object& object = state().object(id);
  require_vertex(object, vertex, "carriers");
  const auto carrier = [&](std::uint32_t local, double weight) -> Carrier {
    const std::uint32_t i = object.begin + local;
    return {i, weight, inverse_mass_awake(state().particles, object, local),
            state().particles.exact_position(i)};
  };
  if (!object.embedding) return {carrier(object.particle_of[vertex], 1)};
  std::vector<Carrier> result;
  for (std::size_t k = 0; k < 4; ++k)
    result.push_back(carrier(object.embedding->vertices[vertex][k], object.embedding->weights[vertex][k]));
  return result;
}

// --- colliders, forces, events -------------------------------------------------------------------

ColliderId World::add_collider(const Shape& shape, const ColliderOptions& options) {
  WorldState& world = state();
  const CallScope call(*world.calls, "add_collider");
  ColliderRecord record{{world.registry->next_id}, options, shape};
  record.since = world.steps;
  record.options.name = world.unique_name(options.name, "collider");
  validate(shape, record.options.name);
  validate(contact_material_of(options), record.options.name);
  if (const auto* const field = std::get_if<SignedDistanceField>(&shape))
    world.warnings.log_info(record.options.name, field->sentences());
  world.dirty.tables = true;
  ++world.registry->next_id;
  world.colliders.push_back(std::move(record));
  const ColliderRecord& added = world.colliders.back();
  try {
    world.registry->names.add(added.options.name, {NameRegistry::Owner::collider, added.id.value});
    world.registry->colliders.add(added.id.value);
  } catch (...) {
    world.registry->names.remove(added.options.name);
    world.colliders.pop_back();
    throw;
  }
  wake_all(world);
  world.contact->invalidate();
  return world.colliders.back().id;
}

void World::remove(ColliderId id) {
  WorldState& world = state();
  const CallScope call(*world.calls, "remove(ColliderId)");
  const ColliderRecord& record = world.collider(id);
  remove_joints_if(world, [id](const JointSide& side) { return side.collider() && *side.collider() == id; });
  remove_ties_if(world, [id](const TieEnd& end) { return end.collider && *end.collider == id; });
  world.registry->names.remove(record.options.name);
  world.colliders.erase(world.colliders.begin() + (&record - world.colliders.data()));
  world.registry->colliders.reset(world.colliders.size(),
                                  [&](std::size_t k) { return world.colliders[k].id.value; });
  world.dirty.tables = true;
  wake_all(world);
  world.contact->invalidate();
}

void World::set_collider(ColliderId id, const Shape& shape, const ColliderOptions& options) {
  WorldState& world = state();
  const CallScope call(*world.calls, "set_collider");
  ColliderRecord& record = world.collider(id);
  validate(shape, record.options.name);
  validate(contact_material_of(options), record.options.name);
  const std::string name = record.options.name;
  if (!options.name.empty() && options.name != name) {
    world.registry->names.require_free(options.name);
    world.registry->names.add(options.name, {NameRegistry::Owner::collider, id.value});
    world.registry->names.remove(name);
  }
  record.shape = shape;
  record.options = options;
  record.arrival.reset();
  if (options.name.empty()) record.options.name = name;
  world.dirty.tables = true;
  wake_all(world);
  world.contact->invalidate();
}

std::vector<ColliderId> World::colliders() const {
  std::vector<ColliderId> ids;
  for (const ColliderRecord& record : state().colliders) ids.push_back(record.id);
  return ids;
}

const Shape& World::shape(ColliderId id) const {
  return state().collider(id).shape;
}
const ColliderOptions& World::collider_options(ColliderId id) const {
  return state().collider(id).options;
}
Transform World::collider_pose(ColliderId id) const {
  WorldState& world = state();
  const QueryScope query(*world.calls, "collider_pose");
  return world.collider(id).options.motion.at(world.time);
}

ColliderId World::find_collider(std::string_view name) const {
  std::vector<std::string_view> names;
  for (const ColliderRecord& record : state().colliders) {
    if (record.options.name == name) return record.id;
    names.push_back(record.options.name);
  }
  throw Error("no collider is named '" + std::string(name) + "'" + nearest_name(name, names));
}

Vec3d World::fluid_force(ColliderId id) const {
  const WorldState& world = state();
  require_readable(*world.calls, "fluid_force");
  require_whole(*world.calls, "fluid_force");
  if (const auto index = world.registry->colliders.find(id.value)) return world.fluids->force(*index);
  throw_stale("collider", id.value);
}

void World::set_pair(std::string_view a, std::string_view b, float friction, float restitution,
                     std::optional<float> kinetic_friction) {
  WorldState& world = state();
  const CallScope call(*world.calls, "set_pair");
  world.contact->pairs.set(a, b, {friction, kinetic_friction.value_or(friction), restitution});
  world.dirty.tables = true;
  wake_all(world);
}

void World::set_collide(std::string_view a, std::string_view b, bool collide) {
  WorldState& world = state();
  const CallScope call(*world.calls, "set_collide");
  world.contact->pairs.set_collide(a, b, collide);
  world.dirty.tables = true;
  wake_all(world);
}

ForceFieldId World::add_force_field(ForceField field) {
  if (!field) throw Error("add_force_field: the function is empty");
  return add_force_field(VertexForceField([field = std::move(field)](const ForcePoint& point) {
    return field(point.position, point.velocity, point.mass, point.time);
  }));
}

ForceFieldId World::add_force_field(VertexForceField field) {
  if (!field) throw Error("add_force_field: the function is empty");
  WorldState& world = state();
  const CallScope call(*world.calls, "add_force_field", From::stages);
  world.callbacks->force_fields.add(world.callbacks->next_id, std::move(field));
  wake_all(world);
  return {world.callbacks->next_id++};
}

void World::remove(ForceFieldId id) {
  WorldState& world = state();
  const CallScope call(*world.calls, "remove(ForceFieldId)", From::stages);
  if (!world.callbacks->force_fields.remove(id.value)) throw_stale("force field", id.value);
  if (!world.current.running) world.callbacks->erase_removed();
  wake_all(world);
}

void World::clear_force_fields() {
  WorldState& world = state();
  const CallScope call(*world.calls, "clear_force_fields", From::stages);
  world.callbacks->force_fields.clear();
  if (!world.current.running) world.callbacks->erase_removed();
  wake_all(world);
}

void World::track_contacts(bool on) {
  WorldState& world = state();
  const CallScope call(*world.calls, "track_contacts");
  world.contact->tracker.track(on);
}

std::span<const ContactPair> World::contact_pairs() const {
  return state().contact->tracker.pairs();
}

void World::set_user_data(ObjectId id, std::uint64_t data) {
  const CallScope call(*state().calls, "set_user_data", From::stages);
  state().object(id).user_data = data;
}
void World::set_user_data(ColliderId id, std::uint64_t data) {
  const CallScope call(*state().calls, "set_user_data", From::stages);
  state().collider(id).user_data = data;
}
std::uint64_t World::user_data(ObjectId id) const {
  return state().object(id).user_data;
}
std::uint64_t World::user_data(ColliderId id) const {
  return state().collider(id).user_data;
}

void World::set_wind(const Wind& wind) {
  Settings changed = settings();
  changed.wind = wind;
  set_settings(changed);
}

void World::set_wind_exposure(ObjectId id, float exposure) {
  WorldState& world = state();
  const CallScope call(*world.calls, "set_wind_exposure", From::stages);
  Object& object = world.object(id);
  if (!(exposure >= 0) || !std::isfinite(exposure))
    throw Error(fmt::format("set_wind_exposure: the exposure of {} is {}, expected a finite number >= 0",
                            object.name, exposure));
  object.wind_exposure = exposure;
  wake_island(world, object);
}

float World::wind_exposure(ObjectId id) const {
  return state().object(id).wind_exposure;
}

void World::set_job_system(JobSystem* jobs) {
  WorldState& world = state();
  const CallScope call(*world.calls, "set_job_system");
  if (jobs && jobs->workers() < 1)
    throw Error(fmt::format("set_job_system: {} workers, expected at least one", jobs->workers()));
  world.jobs = jobs;
  world.threads.reset();
}

void World::set_log(std::function<void(LogLevel, std::string_view)> log) {
  WorldState& world = state();
  const CallScope call(*world.calls, "set_log", From::stages);
  world.warnings.set_log(std::move(log));
}

}  // namespace souple
