#include "souple/world/mirror.h"

#include "souple/assert.h"
#include "souple/geometry/measures.h"
#include "souple/math/fnv1a.h"
#include "souple/objects/object.h"
#include "souple/simd/instruction_set.h"
#include "souple/solver/kernels/find_kernels.h"
#include "souple/solver/kernels/triangles.h"
#include "souple/world/caches.h"
#include "souple/world/impl.h"
#include "souple/world/world.h"

#include <algorithm>

// Users' view of an object, in user order: computed at the first request after a change.

namespace souple {
namespace {

/// Fills `out` with a value for each user vertex: f(i) of its particle i, or the blend over a tet. f returns
/// Vec3d.
template <class Function>
void fill(const Object& object, std::vector<Vec3f>& out, const Function& f) {
  out.reserve(object.capacity);  // constant addresses while particles come and go
  out.resize(object.vertex_count());
  for (std::size_t v = 0; v < out.size(); ++v) {
    if (!object.embedding) {
      SOUPLE_ASSERT(object.begin + object.particle_of[v] < object.end, "a particle of the object");
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

// Minimum number of triangles or vertices per thread.
constexpr std::size_t grain = 1024;

void for_each(const WorldState& world, std::size_t n, RangeFunction f) {
  if (world.threads) return world.threads->for_each(n, grain, f);
  f(0, n);
}

// Per triangle: cross product of two sides; its length is twice the area.
void fill_area_normals(const WorldState& world, std::span<const Triangle> triangles, Mirror& mirror) {
  const std::vector<Vec3f>& x = mirror.positions;
  for_each(world, x.size(), [&](std::size_t v, std::size_t end) {
    for (; v < end; ++v) mirror.position_records[v].set_xyz(x[v]);
  });
  const kernels::TriangleKernels* kernels = find_triangle_kernels(instruction_set());
  const float* records = &mirror.position_records.data()->x;
  const kernels::TriangleArrays arrays{records,          records, records,
                                       triangles.data(), 0,       &mirror.area_normals.data()->x};
  for_each(world, triangles.size(), [&](std::size_t t, std::size_t end) {
    if (kernels) t = kernels->area_normals(arrays, t, end);
    for (; t < end; ++t) {
      const auto [a, b, c] = triangles[t];
      mirror.area_normals[t].set_xyz(cross(x[b] - x[a], x[c] - x[a]));
    }
  });
}

// Sums equal to those of vertex_normals (geometry/measures.h), gathered per vertex.
void fill_normals(const WorldState& world, std::span<const Triangle> triangles, Mirror& mirror) {
  const std::size_t vertices = mirror.positions.size();
  if (mirror.triangles_of.begin.size() != vertices + 1)
    mirror.triangles_of = vertex_triangles(triangles, vertices);
  mirror.normals.resize(vertices);
  mirror.position_records.resize(vertices);
  mirror.area_normals.resize(triangles.size());
  fill_area_normals(world, triangles, mirror);
  for_each(world, vertices, [&](std::size_t v, std::size_t end) {
    for (; v < end; ++v) {
      Vec3f sum;
      for (const std::uint32_t t : mirror.triangles_of.of(v)) sum += mirror.area_normals[t].xyz();
      mirror.normals[v] = unit_normal(sum);
    }
  });
}

}  // namespace

Mirror& fresh_mirror(const WorldState& world, ObjectId id) {
  const Object& object = world.object(id);
  Mirror& mirror = world.caches->mirrors[id.value];
  if (mirror.version == world.version) return mirror;
  fill(object, mirror.positions, [&](std::size_t i) { return world.exact_position(i); });
  mirror.version = world.version;
  return mirror;
}

std::span<const Vec3f> World::positions(ObjectId id) const {
  const std::lock_guard<std::mutex> lock(impl_->state.caches->lock);
  return fresh_mirror(impl_->state, id).positions;
}
std::span<const Vec3f> World::velocities(ObjectId id) const {
  const WorldState& world = impl_->state;
  const Object& object = world.object(id);
  const std::lock_guard<std::mutex> lock(world.caches->lock);
  Mirror& mirror = world.caches->mirrors[id.value];
  if (mirror.velocities_version == world.version) return mirror.velocities;
  fill(object, mirror.velocities, [&](std::size_t i) { return Vec3d(world.particles.velocity[i].xyz()); });
  mirror.velocities_version = world.version;
  return mirror.velocities;
}

std::span<const Vec3f> World::angular_velocities(ObjectId id) const {
  const WorldState& world = impl_->state;
  const Object& object = world.object(id);
  if (!object.traits().rolls) return {};
  const std::lock_guard<std::mutex> lock(world.caches->lock);
  Mirror& mirror = world.caches->mirrors[id.value];
  if (mirror.angular_velocities_version == world.version) return mirror.angular_velocities;
  fill(object, mirror.angular_velocities,
       [&](std::size_t i) { return Vec3d(world.particles.spin[i].xyz()); });
  mirror.angular_velocities_version = world.version;
  return mirror.angular_velocities;
}

std::span<const Vec3f> World::normals(ObjectId id) const {
  const WorldState& world = impl_->state;
  const std::vector<Triangle>& triangles = world.object(id).mesh.triangles;
  if (triangles.empty()) return {};
  const std::lock_guard<std::mutex> lock(world.caches->lock);
  Mirror& mirror = fresh_mirror(world, id);
  if (mirror.normals_version == world.version) return mirror.normals;
  mirror.normals_version = world.version;
  fill_normals(world, triangles, mirror);
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
