#include "souple/stages/forces.h"

#include "souple/math/elementary.h"
#include "souple/objects/object.h"
#include "souple/simd/instruction_set.h"
#include "souple/solver/kernels/find_kernels.h"
#include "souple/solver/kernels/triangles.h"

#include <algorithm>

namespace souple {
namespace {

using kernels::Air;

// A number in [0, 1) from a seed and an index (the finalizer of SplitMix64).
double hashed(std::uint64_t seed, std::uint64_t index) {
  std::uint64_t z = seed + (index + 1) * 0x9e3779b97f4a7c15u;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

// Minimum number of triangles or particles per thread.
constexpr std::size_t force_grain = 512;

void find_triangles_of_particles(Object& object) {
  if (object.triangles.begin.size() == object.particle_count() + 1 &&
      object.triangles.of.size() == 3 * object.surface.size())
    return;
  object.triangles.begin.assign(object.particle_count() + 1, 0);
  object.triangles.of.resize(3 * object.surface.size());
  for (const auto& triangle : object.surface)
    for (const std::uint32_t i : triangle) ++object.triangles.begin[i];
  std::uint32_t sum = 0;
  for (std::uint32_t& begin : object.triangles.begin) begin = sum += begin;
  // Filled from the back: each list's end becomes its begin.
  for (std::size_t t = object.surface.size(); t-- > 0;)
    for (const std::uint32_t i : object.surface[t])
      object.triangles.of[--object.triangles.begin[i]] = static_cast<std::uint32_t>(t);
}

Air air_of(const Wind& settings, const ClothMaterial& material, const Vec3f& wind, float h) {
  return {{wind.x, wind.y, wind.z}, settings.air_density,   material.air_drag,
          material.air_lift,        material.areal_density, h};
}

// A third of the force on one triangle, with the same bits as air_forces of the kernels.
Vec3f third_of_air_force(const Particles& particles, std::uint32_t a, std::uint32_t b, std::uint32_t c,
                         const Air& air) {
  const std::vector<Vec4f>&x = particles.position, &v = particles.velocity;
  const Vec3f sum = v[a].xyz() + v[b].xyz() + v[c].xyz();
  return kernels::air_force(x[b].xyz() - x[a].xyz(), x[c].xyz() - x[a].xyz(),
                            sum * (1.0f / 3) - Vec3f{air.wind[0], air.wind[1], air.wind[2]}, air) *
         (1.0f / 3);
}

void push_triangles(const StageView& stage, const Object& object, const Air& air,
                    std::vector<Vec4f>& triangle_force) {
  const Particles& particles = stage.objects.particles;
  const kernels::TriangleKernels* kernels = find_triangle_kernels(instruction_set());
  const kernels::TriangleArrays arrays{&particles.position.data()->x, &particles.velocity.data()->x,
                                       object.surface.data(), object.begin, &triangle_force.data()->x};
  stage.threads.for_each(object.surface.size(), force_grain, [&](std::size_t t, std::size_t end) {
    if (kernels) t = kernels->air_forces(arrays, air, t, end);
    for (; t < end; ++t) {
      const Triangle& corner = object.surface[t];
      const std::uint32_t first = object.begin;
      triangle_force[t].set_xyz(
          third_of_air_force(particles, first + corner[0], first + corner[1], first + corner[2], air));
    }
  });
}

// Every particle gathers from its triangles: no two threads write to one particle, and the order of the sum
// is fixed.
void gather_forces(const StageView& stage, const Object& object, std::span<const Vec4f> of_triangle) {
  std::vector<Vec4f>& of_particle = stage.objects.particles.start;
  stage.threads.for_each(object.particle_count(), force_grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      Vec3f sum;
      for (std::uint32_t k = object.triangles.begin[i]; k < object.triangles.begin[i + 1]; ++k)
        sum += of_triangle[object.triangles.of[k]].xyz();
      of_particle[object.begin + i].set_xyz(sum);
    }
  });
}

}  // namespace

Vec3f wind_at(const Settings& settings, double t) {
  const Wind& wind = settings.wind;
  if (wind.gust == 0) return wind.velocity;
  double gust = 0;
  constexpr double frequency[] = {1, 2.3, 5.1}, weight[] = {0.6, 0.3, 0.1};
  for (std::uint64_t k = 0; k < 3; ++k) {
    const double phase = hashed(settings.seed, k);
    gust += weight[k] *
            elementary::sin(2 * pi * (frequency[k] * t / static_cast<double>(wind.gust_period) + phase));
  }
  return wind.velocity * static_cast<float>(1 + static_cast<double>(wind.gust) * gust);
}

bool feels_air(const Object& object, const Wind& air) {
  const auto* const material = std::get_if<ClothMaterial>(&object.material);
  return material != nullptr && (material->air_drag > 0 || material->air_lift > 0) && air.air_density > 0 &&
         air.velocity != Vec3f{} && object.sleep.island == 0;
}

void find_air_forces(const StageView& stage, float h, std::vector<Vec4f>& of_triangle) {
  const Wind& settings = stage.settings.wind;
  const Vec3f wind = wind_at(stage.settings, stage.time);
  for (const auto& object : stage.objects.objects) {
    if (!feels_air(*object, settings)) continue;
    const auto& material = std::get<ClothMaterial>(object->material);
    find_triangles_of_particles(*object);
    of_triangle.resize(std::max(of_triangle.size(), object->surface.size()));
    push_triangles(stage, *object, air_of(settings, material, wind * object->wind_exposure, h), of_triangle);
    gather_forces(stage, *object, of_triangle);
  }
}

Vec3f acceleration(const ExternalForces& forces, std::size_t i, const Vec3f& x, const Vec3f& v, double t) {
  const StageView& stage = forces.stage;
  const Particles& particles = stage.objects.particles;
  const Object& object = *stage.objects.objects[stage.objects.object_of[i]];
  const Settings& settings = stage.settings;
  const float w = particles.position[i].w;
  Vec3f a = settings.gravity;
  if (settings.drag > 0) a -= (v - forces.wind * object.wind_exposure) * settings.drag;
  if (feels_air(object, settings.wind)) a += particles.start[i].xyz() * w;
  if (forces.fields.empty()) return a;
  const ForcePoint point{object.id, object.vertex_of[i - object.begin], x, v, particles.mass[i], t};
  forces.fields.for_each([&](const VertexForceField& field) {
    stage.warnings.guarded("a force field", [&] { a += field(point) * w; });
  });
  return a;
}

}  // namespace souple
