#include "souple/queries/mirror.h"

#include "souple/assert.h"
#include "souple/geometry/measures.h"
#include "souple/objects/object.h"
#include "souple/simd/instruction_set.h"
#include "souple/solver/kernels/find_kernels.h"
#include "souple/solver/kernels/triangles.h"
#include "souple/threads/threads.h"

#include <array>

// Users' view of an object, in user order: computed at the first request after a change.

namespace souple {
namespace {

/// Makes room for the values. An array that someone keeps stays as it is if it has another size.
void resize(KeptPoints& out, std::size_t size, std::size_t capacity) {
  if (out.size() != size && out.data() != nullptr && is_kept(out.data())) out = KeptPoints();
  out.reserve(capacity);  // constant addresses while particles come and go
  out.resize(size);
}

// Minimum number of triangles or vertices per thread.
constexpr std::size_t grain = 1024;

void for_each(Threads* threads, std::size_t n, RangeFunction f) {
  if (threads) return threads->for_each(n, grain, f);
  f(0, n);
}
template <class Function>
void each(Threads* threads, std::size_t n, const Function& f) {
  for_each(threads, n, [&f](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) f(k);
  });
}

/// Fills `out` with a value for each user vertex, unless it is up to date. The value is f(i) of its particle i, or the
/// blend over its tet. f returns Vec3d.
template <class Function>
std::span<const Vec3f> filled(const QueryView& view, const Object& object, KeptPoints& out,
                              std::uint64_t& version, const Function& f) {
  if (version == view.version) return out;
  resize(out, object.vertex_count(), object.capacity);
  each(view.threads, out.size(), [&](std::size_t v) {
    if (!object.embedding) {
      SOUPLE_ASSERT(object.begin + object.particle_of[v] < object.end, "a particle of the object");
      out[v] = Vec3f(f(object.begin + object.particle_of[v]));
      return;
    }
    const Tet& tet = object.embedding->vertices[v];
    const std::array<double, 4>& weights = object.embedding->weights[v];
    Vec3d sum;
    for (std::size_t k = 0; k < 4; ++k) sum += f(object.begin + tet[k]) * weights[k];
    out[v] = Vec3f(sum);
  });
  version = view.version;
  return out;
}

// Per triangle: cross product of two sides; its length is twice the area.
void fill_area_normals(Threads* threads, std::span<const Triangle> triangles, Mirror& mirror) {
  const KeptPoints& x = mirror.positions;
  each(threads, x.size(), [&](std::size_t v) { mirror.position_records[v].set_xyz(x[v]); });
  const kernels::TriangleKernels* kernels = find_triangle_kernels(instruction_set());
  const float* records = &mirror.position_records.data()->x;
  const kernels::TriangleArrays arrays{records, records, triangles.data(), 0, &mirror.area_normals.data()->x};
  for_each(threads, triangles.size(), [&](std::size_t t, std::size_t end) {
    if (kernels) t = kernels->area_normals(arrays, t, end);
    for (; t < end; ++t) {
      const auto [a, b, c] = triangles[t];
      mirror.area_normals[t].set_xyz(cross(x[b] - x[a], x[c] - x[a]));
    }
  });
}

// Sums equal to those of vertex_normals (geometry/measures.h), gathered per vertex.
void fill_normals(Threads* threads, std::span<const Triangle> triangles, Mirror& mirror) {
  const std::size_t vertices = mirror.positions.size();
  if (mirror.triangles_of.size() != vertices) mirror.triangles_of = vertex_triangles(triangles, vertices);
  resize(mirror.normals, vertices, vertices);
  mirror.position_records.resize(vertices);
  mirror.area_normals.resize(triangles.size());
  fill_area_normals(threads, triangles, mirror);
  each(threads, vertices, [&](std::size_t v) {
    Vec3f sum;
    for (const std::uint32_t t : mirror.triangles_of[v]) sum += mirror.area_normals[t].xyz();
    mirror.normals[v] = unit_normal(sum);
  });
}

}  // namespace

std::span<const Vec3f> mirrored_positions(const QueryView& view, const Object& object, Mirror& mirror) {
  return filled(view, object, mirror.positions, mirror.version,
                [&](std::size_t i) { return view.particles.exact_position(i); });
}

std::span<const Vec3f> mirrored_velocities(const QueryView& view, const Object& object, Mirror& mirror) {
  return filled(view, object, mirror.velocities, mirror.velocities_version,
                [&](std::size_t i) { return Vec3d(view.particles.velocity[i].xyz()); });
}

std::span<const Vec3f> mirrored_angular_velocities(const QueryView& view, const Object& object,
                                                   Mirror& mirror) {
  return filled(view, object, mirror.angular_velocities, mirror.angular_velocities_version,
                [&](std::size_t i) { return Vec3d(view.particles.spin[i].xyz()); });
}

std::span<const Vec3f> mirrored_normals(const QueryView& view, const Object& object, Mirror& mirror) {
  mirrored_positions(view, object, mirror);
  if (mirror.normals_version == view.version) return mirror.normals;
  fill_normals(view.threads, object.mesh.triangles, mirror);
  mirror.normals_version = view.version;
  return mirror.normals;
}

}  // namespace souple
