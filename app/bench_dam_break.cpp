#include "app/bench.h"
#include "souple/geometry/fill.h"
#include "souple/world/world.h"

#include <algorithm>
#include <chrono>
#include <cmath>

namespace souple::app {

using scene_format::Json;

namespace {

constexpr double spacing = 0.05;    // m
constexpr double dt = 0.002;        // s: usual time step of SPH programs at this spacing
constexpr int iterations = 5;       // Jacobi iterations, after the coarse level
constexpr double collapsing = 0.2;  // s: simulated before the measurement starts

/// A block of water, about n x 2 n x n spacings, at one end of a tank 4 n long.
World dam(double particles, const Settings& settings) {
  Settings own = settings;
  own.substeps = 1;
  own.fluid.iterations = iterations;
  own.fluid.kernel = SmoothingShape::wendland;  // the fastest
  own.measure_residuals = false;
  World world(own);
  const double n = std::max(1.0, std::round(std::cbrt(particles / 2)));
  const double a = n * spacing, height = std::max(1.0, std::round(particles / (n * n))) * spacing;
  world.add_fluid(fill(Vec3d{0, 0, 0}, Vec3d{a, height, a}, spacing),
                  {.spacing = static_cast<float>(spacing), .density = 1000});
  const auto wall = [&](const Vec3f& normal, double offset) {
    world.add_collider(Plane{normal, static_cast<float>(offset)});
  };
  wall({0, 1, 0}, 0);
  wall({1, 0, 0}, 0);
  wall({-1, 0, 0}, -4 * a);
  wall({0, 0, 1}, 0);
  wall({0, 0, -1}, -a);
  return world;
}

}  // namespace

void measure_dam_break(const BenchOptions& options, Json& result) {
  World world = dam(options.size, options.settings);
  // Measurement starts when the front is already moving.
  for (int i = 0; i < options.warm_up + collapsing / dt; ++i) world.step(dt);
  std::vector<double> whole;
  std::array<std::vector<double>, stage_count> stages;
  double error = 0;
  for (int i = 0; i < options.runs; ++i) {
    const auto start = std::chrono::steady_clock::now();
    const StepReport& report = world.step(dt);
    whole.push_back(
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
    for (std::size_t s = 0; s < stage_count; ++s) stages[s].push_back(report.milliseconds[s]);
    error = std::max(error, report.fluid.mean_density_error);
  }
  Json of_stages = Json::object();
  for (std::size_t s = 0; s < stage_count; ++s)
    of_stages.set(std::string(stage_name(static_cast<Stage>(s))), rounded(median(stages[s])));
  result.set("particles", count_json(world.report().particles));
  result.set("kernel", Json::of("wendland"));
  result.set("iterations", Json::whole(iterations));
  result.set("ms_per_step", rounded(median(whole)));
  result.set("ms_fastest", rounded(*std::min_element(whole.begin(), whole.end())));
  result.set("ms_per_stage", std::move(of_stages));
  result.set("density_error", Json::of(std::round(1e6 * error) / 1e6));
  result.set("hash", hash_json(world.hash()));
}

}  // namespace souple::app
