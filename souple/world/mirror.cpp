#include "souple/geometry/measures.h"
#include "souple/math/fnv1a.h"
#include "souple/world/impl.h"

#include <algorithm>

// What users see of an object, in their order: computed once per change, when first asked for.

namespace souple {
namespace {

/// f(i) -> Vec3d of particle i, for every user vertex: the particle's own, or the blend over a tet.
template <class Function>
void fill(const Object& object, std::vector<Vec3f>& out, const Function& f) {
  out.resize(object.vertex_count());
  for (std::size_t v = 0; v < out.size(); ++v) {
    if (!object.embedding) {
      out[v] = Vec3f(f(object.begin + object.particle_of[v]));
      continue;
    }
    const Tet& tet = object.embedding->vertices[v];
    const std::array<double, 4>& weights = object.embedding->weights[v];
    Vec3d sum;
    for (std::size_t k = 0; k < 4; ++k) sum += f(object.begin + tet[k]) * weights[k];
    out[v] = Vec3f(sum);
  }
}

Mirror& fresh_mirror(const WorldState& world, ObjectId id) {
  const Object& object = world.object(id);
  Mirror& mirror = world.mirrors[id.value];
  if (mirror.version == world.version) return mirror;
  fill(object, mirror.positions, [&](std::size_t i) { return world.exact_position(i); });
  mirror.version = world.version;
  return mirror;
}

}  // namespace

std::span<const Vec3f> World::positions(ObjectId id) const {
  return fresh_mirror(impl_->state, id).positions;
}
std::span<const Vec3f> World::velocities(ObjectId id) const {
  const WorldState& world = impl_->state;
  const Object& object = world.object(id);
  Mirror& mirror = world.mirrors[id.value];
  if (mirror.velocities_version == world.version) return mirror.velocities;
  fill(object, mirror.velocities, [&](std::size_t i) { return Vec3d(world.particles.velocity[i].xyz()); });
  mirror.velocities_version = world.version;
  return mirror.velocities;
}

std::span<const Vec3f> World::normals(ObjectId id) const {
  const WorldState& world = impl_->state;
  const std::vector<Triangle>& triangles = world.object(id).mesh.triangles;
  if (triangles.empty()) return {};
  Mirror& mirror = fresh_mirror(world, id);
  if (mirror.normals_version == world.version) return mirror.normals;
  mirror.normals_version = world.version;
  mirror.normals.resize(mirror.positions.size());
  vertex_normals<float>(mirror.positions, triangles, mirror.normals);
  return mirror.normals;
}

std::uint64_t World::hash() const {
  std::vector<const Object*> sorted;
  for (const auto& object : impl_->state.objects) sorted.push_back(object.get());
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
  return impl_->state.version;
}

}  // namespace souple
