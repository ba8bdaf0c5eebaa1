#include "souple/math/fnv1a.h"
#include "souple/math/transform.h"
#include "souple/objects/checks.h"
#include "souple/objects/collider_record.h"
#include "souple/objects/object.h"
#include "souple/queries/caches.h"
#include "souple/queries/crossings.h"
#include "souple/queries/object_sums.h"
#include "souple/queries/overlap.h"
#include "souple/queries/search.h"
#include "souple/stages/energy.h"
#include "souple/stages/rigid_stage.h"
#include "souple/world/call_scope.h"
#include "souple/world/impl.h"
#include "souple/world/prepare.h"
#include "souple/world/rigid_bodies.h"
#include "souple/world/world.h"

#include <algorithm>

#include <fmt/core.h>

// Results that const functions of a world compute from its particles: souple/queries/.

namespace souple {

// --- users' view of an object, in user order: computed at the first request after a change

namespace {

template <class Mirrored>
std::span<const Vec3f> view_of(const WorldState& world, const Object& object, const Mirrored& mirrored) {
  const std::lock_guard<std::mutex> lock(world.caches->lock);
  return mirrored(world.query_view(), object, world.caches->mirrors[object.id.value]);
}

}  // namespace

std::span<const Vec3f> World::positions(ObjectId id) const {
  return view_of(state(), state().object(id), mirrored_positions);
}

std::span<const Vec3f> World::velocities(ObjectId id) const {
  return view_of(state(), state().object(id), mirrored_velocities);
}

std::span<const Vec3f> World::angular_velocities(ObjectId id) const {
  const Object& object = state().object(id);
  if (!object.traits().rolls) return {};
  return view_of(state(), object, mirrored_angular_velocities);
}

std::span<const Vec3f> World::normals(ObjectId id) const {
  const Object& object = state().object(id);
  if (object.mesh.triangles.empty()) return {};
  return view_of(state(), object, mirrored_normals);
}

std::uint64_t World::hash() const {
  std::vector<const Object*> sorted;
  sorted.reserve(state().objects.size());
  for (const auto& object : state().objects) sorted.push_back(object.get());
  std::sort(sorted.begin(), sorted.end(), [](const Object* a, const Object* b) { return a->name < b->name; });
  std::uint64_t hash = fnv1a64_start;
  for (const Object* object : sorted) {
    const auto x = positions(object->id), v = velocities(object->id);
    hash = fnv1a64(std::as_bytes(x), hash);
    hash = fnv1a64(std::as_bytes(v), hash);
  }
  return hash;
}

std::uint64_t World::version() const {
  return state().version;
}

// --- rays and shapes

Hit World::ray_cast(const Vec3f& origin, const Vec3f& direction, double max_distance,
                    const QueryFilter& filter) const {
  const QueryScope query(*state().calls, "ray_cast");
  return souple::ray_cast(state().query_view(), origin, direction, max_distance, filter);
}

std::vector<Hit> World::ray_cast_all(const Vec3f& origin, const Vec3f& direction, double max_distance,
                                     const QueryFilter& filter) const {
  const QueryScope query(*state().calls, "ray_cast_all");
  return souple::ray_cast_all(state().query_view(), origin, direction, max_distance, filter);
}

Hit World::sphere_cast(const Vec3f& origin, float radius, const Vec3f& direction, double max_distance,
                       const QueryFilter& filter) const {
  const QueryScope query(*state().calls, "sphere_cast");
  return souple::sphere_cast(state().query_view(), origin, radius, direction, max_distance, filter);
}

Hit World::closest_point(const Vec3f& point, const QueryFilter& filter) const {
  const QueryScope query(*state().calls, "closest_point");
  return souple::closest_point(state().query_view(), point, filter);
}

std::vector<Overlap> World::overlap(const Shape& shape, const Transform& pose,
                                    const QueryFilter& filter) const {
  validate(shape, "overlap");
  validate(pose, "overlap");
  if (pose.scale != 1) throw Error(fmt::format("overlap: the scale is {}, expected 1", pose.scale));
  const QueryScope query(*state().calls, "overlap");
  return find_overlaps(state().query_view(), shape, pose, filter);
}

std::size_t World::count_crossings(ObjectId id) const {
  const WorldState& world = state();
  return souple::count_crossings(world.query_view(), world.object(id));
}

// --- sums over an object

double World::kinetic_energy(ObjectId id) const {
  const WorldState& world = state();
  const Object& object = world.object(id);
  if (object.traits().rigid) return kinetic_energy_of_body(world, object);
  return souple::kinetic_energy(world.query_view(), object);
}

double World::potential_energy(ObjectId id) const {
  const WorldState& world = state();
  const Object& object = world.object(id);
  if (object.traits().rigid) return potential_energy_of_body(world, object);
  return souple::potential_energy(world.query_view(), object, world.settings.gravity);
}

namespace {

std::span<Projector* const> constraints_of(WorldState& world) {
  if (!world.current.running) bring_constraints_up_to_date(world);
  return world.constraints.lasting();
}

}  // namespace

double World::elastic_energy() const {
  WorldState& world = state();
  const CallScope call(*world.calls, "elastic_energy", From::stages);
  const std::span<Projector* const> constraints = constraints_of(world);
  return souple::elastic_energy(constraints, world.view());
}

double World::unconverged_energy(double dt) const {
  WorldState& world = state();
  const CallScope call(*world.calls, "unconverged_energy", From::stages);
  const std::span<Projector* const> constraints = constraints_of(world);
  return souple::unconverged_energy(constraints, world.view(), substep_of(world.settings, dt),
                                    *world.solving.solver);
}

Vec3d World::momentum(ObjectId id) const {
  const WorldState& world = state();
  const Object& object = world.object(id);
  if (object.traits().rigid) return momentum_of_body(world, object);
  return souple::momentum(world.query_view(), object);
}

Vec3d World::center_of_mass(ObjectId id) const {
  const WorldState& world = state();
  const Object& object = world.object(id);
  if (object.traits().rigid) return world.rigid->pose(id.value)->position;
  return souple::center_of_mass(world.query_view(), object);
}

}  // namespace souple
