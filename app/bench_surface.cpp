#include "app/bench.h"
#include "souple/math/fnv1a.h"
#include "souple/surface/fluid_surface.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <random>
#include <utility>

namespace souple::app {

using scene_format::Json;

namespace {

constexpr float particle_spacing = 0.02f;  // m

/// Own generator: the distributions of the standard library differ between implementations.
class Uniform {
 public:
  double operator()(double lo, double hi) {
    return lo + (hi - lo) * static_cast<double>(random_()) / 4294967296.0;
  }

 private:
  std::mt19937 random_{1};
};

/// A column of water some time after the dam before it broke (Ritter 1892), in units of its height:
///
///   h(x) = (2 - x)^2 / 9,   -1 <= x <= 2;   h = 1 behind, from -1.5 on
///
/// as wide as it was high. One particle in a hundred is spray above it.
std::vector<Vec3f> broken_dam(int count) {
  const double volume = 1.5, height = std::cbrt(0.99 * count / volume);  // spacings
  const auto depth = [&](double x) {
    return x < -height ? height : (2 * height - x) * (2 * height - x) / (9 * height);
  };
  Uniform uniform;
  std::vector<Vec3f> points;
  const auto add = [&](double x, double y, double z) {
    points.push_back(Vec3f(Vec3d{x, y, z} * static_cast<double>(particle_spacing)));
  };
  const auto noise = [&] { return uniform(-0.15, 0.15); };
  for (double x = 0.5 - 1.5 * height; x < 2 * height; ++x)
    for (double y = 0.5; y < depth(x); ++y)
      for (double z = 0.5; z < height; ++z) add(x + noise(), y + noise(), z + noise());
  for (int i = 0; i < count / 100; ++i) {
    const double x = uniform(0, 2 * height);
    add(x, depth(x) + uniform(0, 0.3 * height), uniform(0, height));
  }
  return points;
}

std::uint64_t hash_of(const SurfaceMesh& mesh) {
  std::uint64_t hash = fnv1a64(std::as_bytes(std::span(mesh.positions)));
  hash = fnv1a64(std::as_bytes(std::span(mesh.normals)), hash);
  return fnv1a64(std::as_bytes(std::span(mesh.triangles)), hash);
}

struct Measured {
  std::vector<double> all;
  std::vector<SurfaceTimes> stages;

  Json stage(double SurfaceTimes::*time) const {
    std::vector<double> values;
    for (const SurfaceTimes& times : stages) values.push_back(times.*time);
    return rounded(median(values));
  }
};

Measured measure_surface(FluidSurface& surface, std::span<const Vec3f> points, const BenchOptions& options) {
  const auto threads = make_threads(options.settings.threading, options.settings.threads);
  Measured measured;
  for (int run = 0; run < options.warm_up + options.runs; ++run) {
    const auto start = std::chrono::steady_clock::now();
    surface.build(points, *threads);
    const auto end = std::chrono::steady_clock::now();
    if (run < options.warm_up) continue;
    measured.all.push_back(std::chrono::duration<double, std::milli>(end - start).count());
    measured.stages.push_back(surface.times());
  }
  return measured;
}

}  // namespace

void measure_surface(const BenchOptions& options, Json& result) {
  const std::vector<Vec3f> points = broken_dam(options.size);
  SurfaceOptions shape;
  shape.spacing = particle_spacing;
  FluidSurface surface(shape);
  const Measured measured = measure_surface(surface, points, options);
  shape.method = SurfaceMethod::isotropic;
  FluidSurface other(shape);
  const Measured isotropic = measure_surface(other, points, options);

  Json stages = Json::object();
  stages.set("sort", measured.stage(&SurfaceTimes::sort));
  stages.set("neighbors", measured.stage(&SurfaceTimes::neighbors));
  stages.set("kernels", measured.stage(&SurfaceTimes::kernels));
  stages.set("field", measured.stage(&SurfaceTimes::field));
  stages.set("mesh", measured.stage(&SurfaceTimes::mesh));
  result.set("ms_per_step", rounded(median(measured.all)));
  result.set("ms_fastest", rounded(*std::min_element(measured.all.begin(), measured.all.end())));
  result.set("ms_per_stage", std::move(stages));
  result.set("ms_isotropic", rounded(median(isotropic.all)));
  result.set("particles", count_json(points.size()));
  result.set("vertices", count_json(surface.mesh().positions.size()));
  result.set("triangles", count_json(surface.mesh().triangles.size()));
  result.set("hash", hash_json(hash_of(surface.mesh())));
}

}  // namespace souple::app
