// The three integrators on the same cloth and the same soft body: their elasticity as forces, and as
// constraints of a world with Settings::integrator.
//
// As JSON, for each scene: the largest stable step of each integrator, the change of the energy in a second, and the energy over
// time. Positions are those when explicit Euler has exploded, though its step is far smaller than those of the others. Last, the
// energy of a world.

#include "benchmarks/elastic_integrators.h"

#include "benchmarks/elastic_forces.h"
#include "souple/geometry/builders.h"
#include "souple/world/world.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

namespace souple::benchmarks {
namespace {

constexpr std::pair<const char*, Method> methods[] = {{"explicit", Method::explicit_euler},
                                                      {"semi-implicit", Method::semi_implicit},
                                                      {"implicit", Method::implicit_euler}};
constexpr std::pair<const char*, Integrator> integrators[] = {{"explicit", Integrator::explicit_euler},
                                                              {"semi-implicit", Integrator::semi_implicit},
                                                              {"implicit", Integrator::implicit_euler}};

// --- two scenes, as forces and as constraints of a world: the same mesh, masses, energies and start

/// Cotton of 1 m and n x n vertices without bending stiffness, hung by its upper row. It starts to swing with `spin`
/// rad/s about that row.
struct ClothScene {
  int n;
  double spin;

  TriangleMesh mesh() const {
    TriangleMesh mesh = grid(n, n, 1);
    for (Vec3d& x : mesh.positions) x = {x.x, -x.z - 0.5, 0};
    return mesh;
  }
  ClothMaterial material() const {
    ClothMaterial cotton = material::cotton;
    cotton.bending = BendingModel::none;
    return cotton;
  }
  bool is_pinned(const Vec3d& rest) const { return rest.y > -1e-6; }
  Vec3f velocity(const Vec3d& rest) const { return {0, 0, static_cast<float>(-rest.y * spin)}; }
  ObjectId add(World& world) const { return world.add_cloth(mesh(), material()); }
};

/// A bar of 1 m x 0.2 m x 0.2 m with 25 n^3 tets, straight at the start. One end is fixed.
struct BarScene {
  int n;  ///< cells across

  TetMesh mesh() const { return tet_bar(5 * n, n, n, {1, 0.2, 0.2}); }
  SoftBodyMaterial material() const { return {.young_modulus = 2e6f, .poisson_ratio = 0.4f}; }
  bool is_pinned(const Vec3d& rest) const { return rest.x < -0.5 + 1e-6; }
  Vec3f velocity(const Vec3d&) const { return {}; }
  ObjectId add(World& world) const { return world.add_soft_body(mesh(), material()); }
};

template <class Scene>
std::vector<std::uint32_t> pinned(const Scene& scene) {
  std::vector<std::uint32_t> result;
  const auto mesh = scene.mesh();
  for (std::uint32_t i = 0; i < mesh.positions.size(); ++i)
    if (scene.is_pinned(mesh.positions[i])) result.push_back(i);
  return result;
}

/// Adds the scene to a world with these settings.
template <class Scene>
ObjectId start(const Scene& scene, World& world) {
  const ObjectId object = scene.add(world);
  std::vector<Vec3f> velocity;
  for (const Vec3d& x : scene.mesh().positions) velocity.push_back(scene.velocity(x));
  world.set_velocities(object, velocity);
  world.pin(object, vertices(pinned(scene)));
  return object;
}

// --- as forces

/// The scene after its start.
template <class Scene>
struct Run : ElasticModel {
  explicit Run(const Scene& scene) : ElasticModel(scene.mesh(), scene.material()) {
    pin(pinned(scene));
    for (std::size_t i = 0; i < x.size(); ++i) v[i] = Vec3d(scene.velocity(x[i]));
    before = energy();
  }
  double gain() const { return energy() - before; }

  double before;
};

/// The energy that gravity can release, roughly: the unit of energies.
template <class Scene>
double energy_scale(const Scene& scene) {
  Run model(scene);
  double most = 0;
  for (int i = 0; i < 100; ++i) {
    model.step(Method::implicit_midpoint, 0.01);
    most = std::max(most, model.kinetic_energy());
  }
  return most;
}

/// Energy after `seconds`, minus that at the start, in units of `scale`; infinite once it has grown tenfold.
template <class Scene>
double energy_gain(const Scene& scene, Method method, double h, double seconds, double scale) {
  Run model(scene);
  for (int i = 1; i <= std::lround(seconds / h); ++i) {
    model.step(method, h);
    if (i % 8 == 0 && (!model.is_finite() || model.gain() > 10 * scale)) return HUGE_VAL;
  }
  return model.gain() / scale;
}

// The step below which the energy does not grow tenfold in a second; infinite above 1/60 s, and 0 below 5
// microseconds.
template <class Scene>
double largest_step(const Scene& scene, Method method, double scale) {
  constexpr double most = 1.0 / 60, least = 5e-6;
  if (std::isfinite(energy_gain(scene, method, most, 1, scale))) return HUGE_VAL;
  double low = most, high = most;
  while (!std::isfinite(energy_gain(scene, method, low, 1, scale))) {
    high = low, low /= 2;
    if (low < least) return 0;
  }
  for (int i = 0; i < 4; ++i) {
    const double middle = std::sqrt(low * high);
    (std::isfinite(energy_gain(scene, method, middle, 1, scale)) ? low : high) = middle;
  }
  return low;
}

void print_points(std::span<const Vec3d> x) {
  std::printf("[");
  for (std::size_t i = 0; i < x.size(); ++i)
    std::printf("%s[%.4g, %.4g, %.4g]", i > 0 ? ", " : "", x[i].x, x[i].y, x[i].z);
  std::printf("]");
}

// Energy over time and the positions at `seconds`.
template <class Scene>
void print_run(const Scene& scene, Method method, double h, double seconds, double scale) {
  Run model(scene);
  const auto steps = std::lround(seconds / h), every = std::max(1L, steps / 100);
  std::printf("\"step\": %g, \"energy\": [[0, 0]", h);
  for (long i = 1; i <= steps; ++i) {
    model.step(method, h);
    if (i % every == 0) std::printf(", [%.5g, %.5g]", static_cast<double>(i) * h, model.gain() / scale);
  }
  std::printf("], \"x\": ");
  print_points(model.x);
}

// The time at which explicit Euler has gained `gain` times as much energy as gravity can release.
template <class Scene>
double time_of_explosion(const Scene& scene, double h, double gain, double scale) {
  Run model(scene);
  double t = 0;
  while (model.gain() < gain * scale) model.step(Method::explicit_euler, h), t += h;
  return t;
}

// --- as constraints

double energy_of(const World& world, ObjectId object) {
  return world.kinetic_energy(object) + world.potential_energy(object) + world.elastic_energy();
}

/// Energy after a second, minus that at the start, in units of `scale`. With `field`: a force field also pulls to the
/// plane z = 0, f = -m omega^2 z, without gravity and pins, from z = 0.1 m. The result is then relative to the energy
/// at the start.
template <class Scene>
double world_gain(const Scene& scene, Integrator integrator, int substeps, double scale, double omega) {
  World world({.substeps = substeps, .integrator = integrator, .measure_residuals = false, .threads = 1});
  const bool field = omega > 0;
  ObjectId object;
  if (field) {
    object = scene.add(world);
    Settings settings = world.settings();
    settings.gravity = {};
    world.set_settings(settings);
    world.teleport(object, {.translation = {0, 0, 0.5}});
    const auto k = static_cast<float>(omega * omega);
    world.add_force_field([k](const Vec3f& x, const Vec3f&, float mass, double) {
      return Vec3f{0, 0, -k * mass * x.z};
    });
  } else {
    object = start(scene, world);
  }
  const auto energy = [&] {
    double sum = energy_of(world, object);
    for (const Vec3f& x : world.positions(object))
      sum += field ? 0.5 * omega * omega * static_cast<double>(x.z) * static_cast<double>(x.z) *
                         world.total_mass(object) / static_cast<double>(world.positions(object).size())
                   : 0;
    return sum;
  };
  const double before = energy();
  for (int frame = 0; frame < 60; ++frame)
    if (!world.step(1.0 / 60).ok() || !(std::fabs(energy()) < 1e6 * std::fabs(before) + 1e6)) return HUGE_VAL;
  return (energy() - before) / (field ? before : scale);
}

void print_number(double value) {
  if (std::isfinite(value))
    std::printf("%.4g", value);
  else
    std::printf("null");
}

/// Steps of the runs that are drawn, in order of `methods` [s].
using Steps = std::array<double, 3>;

template <class Scene>
void print(const char* name, const Scene& scene, const Steps& steps, double visible_gain) {
  constexpr double common = 1e-4, of_explosion = 3;
  const double scale = energy_scale(scene);
  const double drawn = time_of_explosion(scene, steps[0], visible_gain, scale);
  std::printf("{\"name\": \"%s\", \"scale\": %.4g, \"common_step\": %g, \"common_explosion\": %.4g, ", name,
              scale, common, time_of_explosion(scene, common, of_explosion, scale));
  std::printf("\"drawn_at\": %.4g,\n \"forces\": [", drawn);
  for (std::size_t k = 0; k < steps.size(); ++k) {
    const auto& [label, method] = methods[k];
    std::printf("%s\n  {\"name\": \"%s\", \"largest_step\": ", k == 0 ? "" : ",", label);
    print_number(largest_step(scene, method, scale));
    for (const auto& [key, h] : {std::pair{"gain_common", common}, std::pair{"gain_600", 1.0 / 600},
                                 std::pair{"gain_60", 1.0 / 60}}) {
      std::printf(", \"%s\": ", key);
      print_number(energy_gain(scene, method, h, 1, scale));
    }
    std::printf(", ");
    print_run(scene, method, steps[k], drawn, scale);
    std::printf("}");
  }
  std::printf("],\n \"constraints\": [");
  for (const auto& [label, integrator] : integrators) {
    std::printf("%s\n  {\"name\": \"%s\"", integrator == Integrator::explicit_euler ? "" : ",", label);
    for (const int substeps : {10, 100}) {
      std::printf(", \"gain_%d\": ", substeps);
      print_number(world_gain(scene, integrator, substeps, scale, 0));
    }
    std::printf(", \"field\": ");
    print_number(world_gain(scene, integrator, 10, scale, 60));
    std::printf("}");
  }
  std::printf("],\n \"triangles\": [");
}

template <class Triangles>
void print_triangles(const Triangles& triangles) {
  for (std::size_t t = 0; t < triangles.size(); ++t)
    std::printf("%s[%u, %u, %u]", t > 0 ? ", " : "", triangles[t][0], triangles[t][1], triangles[t][2]);
  std::printf("]}");
}

}  // namespace

void print_elastic_integrators() {
  std::printf("{\"scenes\": [");
  const ClothScene cloth{.n = 20, .spin = 2};
  print("cloth", cloth, {4e-6, 2e-4, 1.0 / 60}, 1500);
  print_triangles(cloth.mesh().triangles);
  std::printf(",\n");
  const BarScene bar{.n = 4};
  print("soft body", bar, {5e-6, 3e-4, 1.0 / 60}, 2e3);
  World world;
  print_triangles(world.triangles(bar.add(world)));
  std::printf("]}\n");
}

}  // namespace souple::benchmarks
