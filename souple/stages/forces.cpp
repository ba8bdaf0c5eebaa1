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

// Minimum number of triangles per thread, and number of them whose forces are held at once.
constexpr std::size_t force_grain = 512, force_block = 8192;

Air air_of(const Wind& settings, const ClothMaterial& material, const Vec3f& wind) {
  return {{wind.x, wind.y, wind.z}, settings.air_density, material.air_drag, material.air_lift};
}

// A third of the force on one triangle, and its speed, with the same bits as air_forces of the kernels.
Vec4f third_of_air_force(const Particles& particles, std::uint32_t a, std::uint32_t b, std::uint32_t c,
                         const Air& air) {
  const std::vector<Vec4f>& x = particles.position;
  const auto v = [&](std::uint32_t i) { return particles.velocity[i].xyz(); };
  const Vec3f through_air = (v(a) + v(b) + v(c)) * (1.0f / 3) - Vec3f{air.wind[0], air.wind[1], air.wind[2]};
  const float speed = sqrt(dot(through_air, through_air));
  const Vec3f force =
      kernels::air_force(x[b].xyz() - x[a].xyz(), x[c].xyz() - x[a].xyz(), through_air, speed, air);
  return {force.x * (1.0f / 3), force.y * (1.0f / 3), force.z * (1.0f / 3), speed};
}

// Fills `thirds` for triangles [begin, end) of an object.
void push_triangles(const StageView& stage, const Object& object, const Air& air, std::size_t begin,
                    std::size_t end, std::span<Vec4f> thirds) {
  const Particles& particles = stage.objects.particles;
  const kernels::TriangleKernels* kernels = find_triangle_kernels(instruction_set());
  const Triangle* const triangles = object.surface.data() + begin;
  const kernels::TriangleArrays arrays{&particles.position.data()->x, &particles.velocity.data()->x,
                                       triangles, object.begin, &thirds.data()->x};
  stage.threads.for_each(end - begin, force_grain, [&](std::size_t t, std::size_t last) {
    if (kernels) t = kernels->air_forces(arrays, air, t, last);
    for (; t < last; ++t) {
      const auto& [a, b, c] = triangles[t];
      const std::uint32_t first = object.begin;
      thirds[t] = third_of_air_force(particles, first + a, first + b, first + c, air);
    }
  });
}

// An impulse at most stops a particle relative to the air, |F| h <= m V; V is the speed of the fastest triangle around it. So
// light cloth stays stable in any wind, and so does cloth that is torn apart.
void limit_forces(const StageView& stage, std::span<Vec4f> force, std::uint32_t first, float h) {
  stage.threads.each(force.size(), force_grain, [&](std::size_t k) {
    const Vec3f dv = force[k].xyz() * (h * stage.objects.particles.position[first + k].w);
    if (dot(dv, dv) > force[k].w * force[k].w) force[k].set_xyz(force[k].xyz() * (force[k].w / length(dv)));
  });
}

// Blocks of triangles stay in the cache. One thread adds the forces, so the order of each sum is fixed.
void push_object(const StageView& stage, const Object& object, const Air& air, float h,
                 std::span<Vec4f> thirds) {
  Vec4f* const force = stage.objects.particles.start.data() + object.begin;
  std::fill(force, force + object.particle_count(), Vec4f{});
  for (std::size_t begin = 0; begin < object.surface.size(); begin += thirds.size()) {
    const std::size_t end = std::min(begin + thirds.size(), object.surface.size());
    push_triangles(stage, object, air, begin, end, thirds);
    for (std::size_t t = begin; t < end; ++t)
      for (const std::uint32_t i : object.surface[t])
        force[i].set_xyz(force[i].xyz() + thirds[t - begin].xyz()),
            force[i].w = max(force[i].w, thirds[t - begin].w);
  }
  limit_forces(stage, {force, object.particle_count()}, object.begin, h);
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
         object.sleep.island == 0;
}

void find_air_forces(const StageView& stage, float h, std::vector<Vec4f>& thirds) {
  const Wind& settings = stage.settings.wind;
  const Vec3f wind = wind_at(stage.settings, stage.time);
  for (const auto& object : stage.objects.objects) {
    if (!feels_air(*object, settings)) continue;
    const auto& material = std::get<ClothMaterial>(object->material);
    thirds.resize(std::max(thirds.size(), std::min(force_block, object->surface.size())));
    push_object(stage, *object, air_of(settings, material, wind * object->wind_exposure), h, thirds);
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
