#include "souple/world/forces.h"

#include <algorithm>
#include <cmath>

namespace souple {
namespace {

// A number in [0, 1) from a seed and an index (the finaliser of SplitMix64).
double hashed(std::uint64_t seed, std::uint64_t index) {
  std::uint64_t z = seed + (index + 1) * 0x9e3779b97f4a7c15u;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

struct Air {
  float density, drag, lift;
};

// With v the triangle's velocity through the air, n its normal, A its area:
//   drag = -rho/2 c_d A |v.n| v
//   lift = -rho/2 c_l A (v.n) |v| (n - (n.v) v / |v|^2)
// The impulse is capped at what stops the triangle in the air: light cloth stays stable at any wind.
Vec3f air_force(const Vec3f (&x)[3], const Vec3f& v, const Air& air, float mass, float h) {
  const float speed = length(v);
  const Vec3f normal = cross(x[1] - x[0], x[2] - x[0]);
  const float twice_area = length(normal);
  if (!(speed > 0) || !(twice_area > 0)) return {};
  const Vec3f n = normal / twice_area;
  const float vn = dot(v, n);
  const float q = 0.5f * air.density * 0.5f * twice_area;
  const Vec3f across = n - v * (vn / (speed * speed));
  const Vec3f force = v * (-q * air.drag * std::fabs(vn)) - across * (q * air.lift * vn * speed);
  const float most = mass * speed / h;
  const float size = length(force);
  return size > most ? force * (most / size) : force;
}

// How many triangles or particles are worth a thread of their own.
constexpr std::size_t grain = 512;

void find_triangles_of_particles(Object& object) {
  if (object.triangle_begin.size() == object.particle_count() + 1 &&
      object.triangles_of.size() == 3 * object.surface.size())
    return;
  object.triangle_begin.assign(object.particle_count() + 1, 0);
  object.triangles_of.resize(3 * object.surface.size());
  for (const auto& triangle : object.surface)
    for (const std::uint32_t i : triangle) ++object.triangle_begin[i];
  std::uint32_t sum = 0;
  for (std::uint32_t& begin : object.triangle_begin) begin = sum += begin;
  // Filled from the back, each list's end becomes its beginning.
  for (std::size_t t = object.surface.size(); t-- > 0;)
    for (const std::uint32_t i : object.surface[t])
      object.triangles_of[--object.triangle_begin[i]] = static_cast<std::uint32_t>(t);
}

// A third of the force on each triangle.
void push_triangles(const Object& object, const ClothMaterial& material, const Vec3f& wind, float h,
                    WorldState& world) {
  const Air air{world.settings.wind.air_density, material.air_drag, material.air_lift};
  const Particles& particles = world.particles;
  const ParticleView view = world.view();
  world.threads->for_each(object.surface.size(), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      const auto& triangle = object.surface[t];
      const std::uint32_t a = object.begin + triangle[0], b = object.begin + triangle[1],
                          c = object.begin + triangle[2];
      const Vec3f x[3] = {{}, view.difference(b, a), view.difference(c, a)};
      const Vec3f v =
          (particles.velocity[a].xyz() + particles.velocity[b].xyz() + particles.velocity[c].xyz()) *
              (1.0f / 3) -
          wind;
      const float mass = 0.5f * length(cross(x[1], x[2])) * material.areal_density;
      world.triangle_force[t].set_xyz(air_force(x, v, air, mass, h) * (1.0f / 3));
    }
  });
}

// Every particle gathers from its triangles: no two threads write one, and the order of the sum is fixed.
void gather_forces(const Object& object, WorldState& world) {
  world.threads->for_each(object.particle_count(), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      Vec3f sum;
      for (std::uint32_t k = object.triangle_begin[i]; k < object.triangle_begin[i + 1]; ++k)
        sum += world.triangle_force[object.triangles_of[k]].xyz();
      world.force[object.begin + i].set_xyz(sum);
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
    gust += weight[k] * std::sin(2 * pi * (frequency[k] * t / static_cast<double>(wind.gust_period) + phase));
  }
  return wind.velocity * static_cast<float>(1 + static_cast<double>(wind.gust) * gust);
}

bool accumulate_wind(WorldState& world, float h) {
  const bool windy = !(world.settings.wind.velocity == Vec3f{});
  if (!windy) return false;
  const Vec3f wind = wind_at(world.settings, world.time);
  world.force.resize(world.particles.size());
  for (const auto& object : world.objects) {
    if (const auto* material = std::get_if<ClothMaterial>(&object->material)) {
      find_triangles_of_particles(*object);
      world.triangle_force.resize(std::max(world.triangle_force.size(), object->surface.size()));
      push_triangles(*object, *material, wind, h, world);
      gather_forces(*object, world);
    } else {
      std::fill(world.force.begin() + object->begin, world.force.begin() + object->end, Vec4f{});
    }
  }
  return true;
}

Vec3f acceleration(WorldState& world, std::size_t i, const Vec3f& x, const Vec3f& v, bool windy,
                   const Vec3f& wind, double t) {
  const Settings& settings = world.settings;
  const float w = world.particles.position[i].w;
  Vec3f a = settings.gravity;
  if (settings.drag > 0) a -= (v - wind) * settings.drag;
  if (windy) a += world.force[i].xyz() * w;
  for (const ForceField& field : world.force_fields)
    world.guarded("a force field", [&] { a += field(x, v, world.particles.mass[i], t) * w; });
  return a;
}

Vec3f implicit_velocity(WorldState& world, std::size_t i, const Vec3f& x, const Vec3f& v0, float h,
                        bool windy, const Vec3f& wind, double t) {
  const auto residual = [&](const Vec3f& v) {
    return v - v0 - acceleration(world, i, x + v * h, v, windy, wind, t) * h;
  };
  // The field is differenced over a step that is small beside v and h a, but far above float's rounding.
  Vec3f v = v0;
  for (int iteration = 0; iteration < 8; ++iteration) {
    const Vec3f r = residual(v);
    const float scale = length(v) + length(r) + 1e-3f;
    if (!(length(r) > 1e-6f * scale)) break;
    const float e = 1e-2f * scale;
    Mat3f jacobian;
    for (int k = 0; k < 3; ++k) {
      Vec3f ahead = v, behind = v;
      ahead[k] += e, behind[k] -= e;
      jacobian.column[k] = (residual(ahead) - residual(behind)) / (2 * e);
    }
    const Vec3f dv = inverse(jacobian) * r;
    if (!is_finite(dv)) break;
    v -= dv;
  }
  return v;
}

}  // namespace souple
