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
Vec3f third_of_air_force(const ParticleView& view, std::span<const Vec4f> velocity, std::uint32_t a,
                         std::uint32_t b, std::uint32_t c, const Air& air) {
  const Vec3f sum = velocity[a].xyz() + velocity[b].xyz() + velocity[c].xyz();
  const Vec3f v = sum * (1.0f / 3) - Vec3f{air.wind[0], air.wind[1], air.wind[2]};
  return kernels::air_force(view.difference(b, a), view.difference(c, a), v, air) * (1.0f / 3);
}

void push_triangles(const StageView& stage, const Object& object, const Air& air,
                    std::vector<Vec4f>& triangle_force) {
  const ParticleView view = stage.objects.view();
  const std::vector<Vec4f>& velocity = stage.objects.particles.velocity;
  const kernels::TriangleKernels* kernels = find_triangle_kernels(instruction_set());
  const kernels::TriangleArrays arrays{
      &view.position.data()->x, &view.moving.data()->x, &velocity.data()->x,
      object.surface.data(),    object.begin,           &triangle_force.data()->x};
  stage.threads.for_each(object.surface.size(), force_grain, [&](std::size_t t, std::size_t end) {
    if (kernels) t = kernels->air_forces(arrays, air, t, end);
    for (; t < end; ++t) {
      const Triangle& corner = object.surface[t];
      const std::uint32_t first = object.begin;
      triangle_force[t].set_xyz(
          third_of_air_force(view, velocity, first + corner[0], first + corner[1], first + corner[2], air));
    }
  });
}

// Every particle gathers from its triangles: no two threads write to one particle, and the order of the sum
// is fixed.
void gather_forces(const Object& object, WindForces& forces, Threads& threads) {
  threads.for_each(object.particle_count(), force_grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      Vec3f sum;
      for (std::uint32_t k = object.triangles.begin[i]; k < object.triangles.begin[i + 1]; ++k)
        sum += forces.of_triangle[object.triangles.of[k]].xyz();
      forces.of_particle[object.begin + i].set_xyz(sum);
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

bool find_wind_forces(const StageView& stage, float h, WindForces& forces) {
  const Wind& settings = stage.settings.wind;
  if (settings.velocity == Vec3f{}) return false;
  const Vec3f wind = wind_at(stage.settings, stage.time);
  forces.of_particle.resize(stage.objects.particles.size());
  for (const auto& object : stage.objects.objects) {
    if (const auto* material = std::get_if<ClothMaterial>(&object->material)) {
      find_triangles_of_particles(*object);
      forces.of_triangle.resize(std::max(forces.of_triangle.size(), object->surface.size()));
      push_triangles(stage, *object, air_of(settings, *material, wind * object->wind_exposure, h),
                     forces.of_triangle);
      gather_forces(*object, forces, stage.threads);
    } else {
      std::fill(forces.of_particle.data() + object->begin, forces.of_particle.data() + object->end, Vec4f{});
    }
  }
  return true;
}

Vec3f acceleration(const ExternalForces& forces, std::size_t i, const Vec3f& x, const Vec3f& v, double t) {
  const StageView& stage = forces.stage;
  const ObjectsView& objects = stage.objects;
  const Settings& settings = stage.settings;
  const float w = objects.particles.position[i].w;
  Vec3f a = settings.gravity;
  if (settings.drag > 0)
    a -= (v - forces.wind * objects.objects[objects.object_of[i]]->wind_exposure) * settings.drag;
  if (!forces.wind_of_particle.empty()) a += forces.wind_of_particle[i].xyz() * w;
  if (forces.fields.empty()) return a;
  const Object& object = *objects.objects[objects.object_of[i]];
  const ForcePoint point{object.id, object.vertex_of[i - object.begin], x, v, objects.particles.mass[i], t};
  forces.fields.for_each([&](const VertexForceField& field) {
    stage.warnings.guarded("a force field", [&] { a += field(point) * w; });
  });
  return a;
}

}  // namespace souple
