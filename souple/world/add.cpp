#include "souple/world/add.h"

#include "souple/assert.h"
#include "souple/fluid/emitter_record.h"
#include "souple/geometry/tet_mesh.h"
#include "souple/objects/kinds/kinds.h"
#include "souple/objects/object.h"
#include "souple/objects/obstacle_pose.h"
#include "souple/objects/rigid_definition.h"
#include "souple/queries/caches.h"
#include "souple/stages/rigid_stage.h"
#include "souple/stages/user_constraint.h"
#include "souple/world/call_scope.h"
#include "souple/world/contact_state.h"
#include "souple/world/impl.h"
#include "souple/world/joints/joints.h"
#include "souple/world/joints/ties.h"
#include "souple/world/registry.h"
#include "souple/world/world.h"

#include <algorithm>
#include <utility>

#include <fmt/core.h>

namespace souple {
namespace {

/// A free name for an object to be added.
std::string new_name(const WorldState& world, ObjectKind kind, const ObjectOptions& options) {
  return world.unique_name(options.name, kind_name(kind));
}

void set_motion(WorldState& world, const Object& object, const ObjectOptions& options) {
  if (object.particle_count() == 0) return;
  Vec3d center;
  double mass = 0;
  for (std::uint32_t i = object.begin; i < object.end; ++i) {
    const auto m = static_cast<double>(world.particles.mass[i]);
    center += object.rest[i - object.begin] * m;
    mass += m;
  }
  center = center / mass;
  const bool rolls = object.traits().rolls;
  for (std::uint32_t i = object.begin; i < object.end; ++i) {
    const Vec3d r = object.rest[i - object.begin] - center;
    world.particles.velocity[i].set_xyz(
        Vec3f(Vec3d(options.velocity) + cross(Vec3d(options.angular_velocity), r)));
    if (rolls) world.particles.spin[i].set_xyz(options.angular_velocity);
  }
}

/// Creates the object's particles.
void add_particles(WorldState& world, const NewObject& made, const ObjectOptions& options) {
  const Object& object = *made.object;
  Particles& particles = world.particles;
  particles.resize(object.reserved_end());
  if (object.traits().rolls && !particles.has_spin()) particles.add_spin();
  world.object_of.resize(object.reserved_end(), static_cast<std::uint32_t>(world.objects.size()));
  for (std::uint32_t i = object.begin; i < object.end; ++i) {
    const double mass = made.mass[i - object.begin];
    particles.mass[i] = static_cast<float>(mass);
    particles.position[i].w = mass > 0 ? static_cast<float>(1 / mass) : 0.0f;
    world.teleport_particle(i, object.rest[i - object.begin]);
  }
  if (!object.traits().driven && !object.traits().rigid) set_motion(world, object, options);
}

/// The body that moves the particles of a rigid body.
void add_body(WorldState& world, const Object& object, RigidDefinition definition,
              const ObjectOptions& options) {
  const BodyVelocity velocity{Vec3d(options.velocity), Vec3d(options.angular_velocity)};
  const Vec3d center = definition.pose.position;
  world.rigid->add(object.id.value, std::move(definition));
  world.rigid->set_velocity(object.id.value, velocity);
  for (std::uint32_t i = object.begin; i < object.end; ++i)
    world.particles.velocity[i].set_xyz(Vec3f(velocity.at(object.rest[i - object.begin] - center)));
}

/// Leaves nothing of an object that could not be added for lack of memory.
void take_back(WorldState& world, const Object& object, bool had_spin) {
  world.registry->names.remove(object.name);
  world.registry->objects.remove_last(object.id.value);
  world.rigid->remove_if([&](std::uint32_t id) { return id == object.id.value; });
  world.particles.resize(object.begin);
  if (!had_spin) world.particles.spin = {}, world.particles.turn = {};
  world.object_of.resize(object.begin);
}

/// Adds an object to the world, or changes nothing.
ObjectId add(WorldState& world, NewObject made, const ObjectOptions& options) {
  Object& object = *made.object;
  world.warnings.log_info(object.name, made.sentences);
  object.id = {world.registry->next_id++};
  object.collision.since = world.steps;
  object.begin = static_cast<std::uint32_t>(world.particles.size());
  object.end = object.begin + static_cast<std::uint32_t>(object.rest.size());
  world.dirty.all();
  world.contact->invalidate();
  ++world.version;
  const bool had_spin = world.particles.has_spin();
  try {
    add_particles(world, made, options);
    world.registry->names.add(object.name, {NameRegistry::Owner::object, object.id.value});
    world.registry->objects.add(object.id.value);
    world.objects.push_back(std::move(made.object));
    if (made.rigid) add_body(world, object, std::move(*made.rigid), options);
  } catch (...) {
    take_back(world, object, had_spin);
    throw;
  }
  SOUPLE_ASSERT(world.object_of.size() == world.particles.size(), "every particle belongs to an object");
  return world.objects.back()->id;
}

/// The density solver supports a single spacing.
void require_same_spacing(const WorldState& world, const std::string& name, float spacing) {
  for (const auto& other : world.objects) {
    const auto* material = std::get_if<FluidMaterial>(&other->material);
    if (material && material->spacing != spacing)
      throw Error(fmt::format(
          "{}: spacing is {} m, but that of {} is {} m: all fluids of a world must have the same spacing",
          name, spacing, other->name, material->spacing));
  }
}

}  // namespace

void scale_mass(WorldState& world, const Object& object, float factor) {
  world.dirty.masses = true;
  for (std::uint32_t i = object.begin; i < object.end; ++i) {
    world.particles.mass[i] *= factor;
    if (world.particles.position[i].w > 0) world.particles.position[i].w = 1 / world.particles.mass[i];
  }
}

void require_permanent_particles(const Object& object, const char* what) {
  if (object.traits().flows)
    throw Error(
        std::string(what) + ": " + object.name +
        " is a fluid, whose particles come and go; contain it with walls, or push it with a force field");
}

void require_movable(const Object& object, const char* what) {
  if (object.traits().driven)
    throw Error(std::string(what) + ": " + object.name +
                " is an obstacle, which only its motion moves; use set_motion");
}

void erase_particles(WorldState& world, std::span<const IndexRange> ranges) {
  world.particles.erase(ranges);
  erase_ranges(world.object_of, ranges);
  std::uint32_t erased = 0;
  std::size_t next = 0;
  for (const auto& object : world.objects) {
    for (; next < ranges.size() && ranges[next].end <= object->begin; ++next)
      erased += static_cast<std::uint32_t>(ranges[next].end - ranges[next].begin);
    object->begin -= erased, object->end -= erased;
  }
  for (std::size_t k = ranges.size(); k-- > 0;) {
    const auto begin = static_cast<std::uint32_t>(ranges[k].begin),
               end = static_cast<std::uint32_t>(ranges[k].end);
    for (UserConstraint& user : world.constraints.users) user.erase_particles(begin, end);
    world.contact->contacts.erase_particles(begin, end);
  }
  world.dirty.all();
  world.contact->invalidate();
  ++world.version;
}

ObjectId World::add_cloth(const TriangleMesh& mesh, const ClothMaterial& material,
                          const ObjectOptions& options) {
  WorldState& world = state();
  const CallScope call(*world.calls, "add_cloth");
  return add(world, import_cloth(new_name(world, ObjectKind::cloth, options), mesh, material, options),
             options);
}

ObjectId World::add_soft_body(const TetMesh& mesh, const SoftBodyMaterial& material,
                              const ObjectOptions& options) {
  WorldState& world = state();
  const CallScope call(*world.calls, "add_soft_body");
  return add(world,
             import_soft_body(new_name(world, ObjectKind::soft_body, options), mesh, material, options),
             options);
}

ObjectId World::add_soft_body(const TriangleMesh& surface, const SoftBodyMaterial& material,
                              const LatticeOptions& lattice, const ObjectOptions& options) {
  WorldState& world = state();
  const CallScope call(*world.calls, "add_soft_body");
  std::string name = new_name(world, ObjectKind::soft_body, options);
  return add(world, import_soft_body(std::move(name), surface, material, lattice, options), options);
}

ObjectId World::add_rope(std::span<const Vec3d> points, std::uint32_t segments, const RopeMaterial& material,
                         const ObjectOptions& options) {
  WorldState& world = state();
  const CallScope call(*world.calls, "add_rope");
  std::string name = new_name(world, ObjectKind::rope, options);
  return add(world, import_rope(std::move(name), points, segments, material, options), options);
}

ObjectId World::add_grains(std::span<const Vec3d> centers, const GrainsMaterial& material,
                           const ObjectOptions& options) {
  WorldState& world = state();
  const CallScope call(*world.calls, "add_grains");
  return add(world, import_grains(new_name(world, ObjectKind::grains, options), centers, material, options),
             options);
}

ObjectId World::add_fluid(std::span<const Vec3d> centers, const FluidMaterial& material,
                          const ObjectOptions& options) {
  WorldState& world = state();
  const CallScope call(*world.calls, "add_fluid");
  NewObject fluid = import_fluid(new_name(world, ObjectKind::fluid, options), centers, material, options);
  require_same_spacing(world, fluid.object->name, material.spacing);
  return add(world, std::move(fluid), options);
}

ObjectId World::add_fluid(const TriangleMesh& surface, const FluidMaterial& material,
                          const ObjectOptions& options) {
  WorldState& world = state();
  const CallScope call(*world.calls, "add_fluid");
  NewObject fluid = import_fluid(new_name(world, ObjectKind::fluid, options), surface, material, options);
  require_same_spacing(world, fluid.object->name, material.spacing);
  return add(world, std::move(fluid), options);
}

ObjectId World::add_rigid_body(const TriangleMesh& mesh, const RigidBodyMaterial& material,
                               const ObjectOptions& options) {
  WorldState& world = state();
  const CallScope call(*world.calls, "add_rigid_body");
  std::string name = new_name(world, ObjectKind::rigid_body, options);
  return add(world, import_rigid_body(std::move(name), mesh, material, options), options);
}

ObjectId World::add_rigid_body(const Shape& shape, const RigidBodyMaterial& material,
                               const ObjectOptions& options) {
  WorldState& world = state();
  const CallScope call(*world.calls, "add_rigid_body");
  std::string name = new_name(world, ObjectKind::rigid_body, options);
  return add(world, import_rigid_body(std::move(name), shape, material, options), options);
}

ObjectId World::add_rigid_body(std::span<const RigidPart> parts, const RigidBodyMaterial& material,
                               const ObjectOptions& options) {
  WorldState& world = state();
  const CallScope call(*world.calls, "add_rigid_body");
  std::string name = new_name(world, ObjectKind::rigid_body, options);
  return add(world, import_rigid_body(std::move(name), parts, material, options), options);
}

ObjectId World::add_obstacle(const TriangleMesh& mesh, const ObstacleMaterial& material,
                             ObstacleMotion motion, const ObjectOptions& options) {
  WorldState& world = state();
  const CallScope call(*world.calls, "add_obstacle");
  std::string name = new_name(world, ObjectKind::obstacle, options);
  NewObject obstacle = import_obstacle(std::move(name), mesh, material, std::move(motion), options);
  const std::vector<Vec3d> now = obstacle_positions(*obstacle.object, world.time);
  const ObjectId id = add(world, std::move(obstacle), options);
  const std::uint32_t begin = world.object(id).begin;
  for (std::uint32_t k = 0; k < now.size(); ++k) world.teleport_particle(begin + k, now[k]);
  return id;
}

}  // namespace souple
