#include "app/bench.h"
#include "app/bench_scenes.h"
#include "app/option_names.h"
#include "souple/world/debug_draw.h"
#include "souple/world/profile.h"
#include "souple/world/world.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>

namespace souple::app {

using scene_format::Json;

namespace {

using Clock = std::chrono::steady_clock;

constexpr double frame_time = 1.0 / 60;     // s, of every solve
constexpr double projection_budget = 0.25;  // s, to time the projections of all kinds
constexpr double residual_budget = 8;       // s, for one solve to the target residual
constexpr double repeated_below = 0.1;      // s: shorter times are the best of three
constexpr int max_iterations = 1 << 16;
constexpr double stretched = 0.1;  // strain of the static case

/// Lengths of all edges of tets, in a fixed order.
std::vector<double> tet_edge_lengths(const World& world) {
  std::vector<double> lengths;
  DebugDraw draw;
  draw.tet_edge = [&](const Vec3f& a, const Vec3f& b) { lengths.push_back(length(Vec3d(a) - Vec3d(b))); };
  world.debug_draw(draw);
  return lengths;
}

double largest_strain(const World& world, const std::vector<double>& rest) {
  double largest = 0;
  DebugDraw draw;
  draw.constraint = [&](const DebugConstraint& constraint) {
    largest = std::max(largest, static_cast<double>(constraint.strain));
  };
  world.debug_draw(draw);
  const std::vector<double> now = tet_edge_lengths(world);
  for (std::size_t i = 0; i < now.size(); ++i) largest = std::max(largest, now[i] / rest[i] - 1);
  return largest;
}

/// Runs one step; throws NonFiniteError, or Error where it was refused or a callback failed.
const StepReport& step(World& world, double dt) {
  const StepReport& report = world.step(dt);
  if (report.outcome == StepOutcome::diverged) throw NonFiniteError{report.message};
  if (!report.ok() || report.has(Flag::callback_failed)) throw Error(report.message);
  return report;
}

/// Medians of the steps; returns that of a whole step. [ms]
double time_steps(World& world, double dt, const BenchOptions& options, Json& result) {
  for (int i = 0; i < options.warm_up; ++i) step(world, dt);
  std::vector<double> whole;
  std::array<std::vector<double>, stage_count> stages;
  double density_error = 0;
  for (int i = 0; i < options.runs; ++i) {
    const auto start = Clock::now();
    const StepReport& report = step(world, dt);
    const std::chrono::duration<double, std::milli> spent = Clock::now() - start;
    whole.push_back(spent.count());
    for (std::size_t s = 0; s < stage_count; ++s) stages[s].push_back(report.milliseconds[s]);
    density_error = std::max(density_error, report.fluid.mean_density_error);
  }
  const double all = median(whole);
  double sum = 0;
  Json of_stages = Json::object();
  for (std::size_t s = 0; s < stage_count; ++s) {
    const double one = median(stages[s]);
    of_stages.set(std::string(stage_name(static_cast<Stage>(s))), rounded(one));
    sum += one;
  }
  of_stages.set("other", rounded(std::max(0.0, all - sum)));
  result.set("ms_per_step", rounded(all));
  result.set("ms_fastest", rounded(*std::min_element(whole.begin(), whole.end())));
  result.set("ms_per_stage", std::move(of_stages));
  if (density_error > 0) result.set("density_error", rounded(density_error));
  return all;
}

Json time_projections(World& world) {
  double once = 0;
  for (const KindTime& kind : world.time_projections(frame_time, 3)) once += kind.seconds;
  const int sweeps = static_cast<int>(std::clamp(projection_budget / std::max(once, 1e-9), 5.0, 2000.0));
  // Per kind: number of constraints, and seconds.
  std::vector<std::pair<std::string, std::pair<double, double>>> kinds;
  for (const KindTime& time : world.time_projections(frame_time, sweeps)) {
    const std::string name(time.kind);
    auto kind = std::find_if(kinds.begin(), kinds.end(), [&](const auto& k) { return k.first == name; });
    if (kind == kinds.end()) kind = kinds.insert(kinds.end(), {name, {0, 0}});
    kind->second.first += static_cast<double>(time.count);
    kind->second.second += time.seconds;
  }
  Json result = Json::object();
  for (const auto& [name, total] : kinds)
    result.set(name, rounded(total.first / std::max(total.second, 1e-12)));
  return result;
}

/// Convergence of a solver: strains and energy after some iterations, and the time these took.
struct CurvePoint {
  int iterations = 0;
  double milliseconds = 0;
  double mean_strain = 0, rms_strain = 0, largest_strain = 0;
  double energy = 0;  // 1/2 sum C^2 of the distances [J at 1 N/m]

  Json json() const {
    Json entry = Json::object();
    entry.set("iterations", Json::whole(iterations));
    entry.set("ms", rounded(milliseconds));
    entry.set("mean_strain", rounded(mean_strain));
    entry.set("rms_strain", rounded(rms_strain));
    entry.set("largest_strain", rounded(largest_strain));
    entry.set("energy", rounded(energy));
    return entry;
  }
};

CurvePoint solve(World& world, int iterations) {
  SolveTime best = world.time_solve(frame_time, iterations);
  for (int again = 0; again < 2 && best.seconds < repeated_below; ++again)
    best.seconds = std::min(best.seconds, world.time_solve(frame_time, iterations).seconds);
  return {iterations,      best.seconds * 1e3,  best.mean_strain,
          best.rms_strain, best.largest_strain, best.energy};
}

/// Smallest number of iterations that reaches the target, between a count that is too small and one that
/// suffices. Accurate to 3 %. Where another try would take long: interpolated linearly between both counts in
/// log-log scale.
CurvePoint min_iterations(World& world, double target, CurvePoint too_few, CurvePoint enough) {
  while (enough.iterations - too_few.iterations > std::max(1, enough.iterations / 32)) {
    if (enough.milliseconds > 1e3 * repeated_below) {
      const double part =
          std::log(too_few.mean_strain / target) / std::log(too_few.mean_strain / enough.mean_strain);
      const auto between = [&](double a, double b) { return a * std::pow(b / a, part); };
      enough.iterations = static_cast<int>(std::ceil(between(too_few.iterations, enough.iterations)));
      enough.milliseconds = between(too_few.milliseconds, enough.milliseconds);
      return enough;
    }
    const CurvePoint middle = solve(world, (too_few.iterations + enough.iterations) / 2);
    (middle.mean_strain <= target ? enough : too_few) = middle;
  }
  return enough;
}

/// Solve of the stretched cloth to a mean strain, without forces or velocities. Each iteration count is solved from scratch, so
/// acceleration over iterations has the effect that it has in use.
Json time_to_residual(const BenchScene& scene, const BenchOptions& options) {
  const double target = *options.residual;
  Settings settings = options.settings;
  settings.gravity = {};
  World world(settings);
  scene.build(world, options.size);
  stretch_cloths(world, stretched);
  world.time_solve(frame_time, 1);  // excludes what the first solve prepares
  const CurvePoint start = solve(world, 0);
  CurvePoint before = start, point = start;
  Json curve = Json::array();
  double growth = std::sqrt(2.0);
  for (int n = 1; n <= max_iterations; n = std::max(n + 1, static_cast<int>(n * growth))) {
    before = point;
    point = solve(world, n);
    curve.items.push_back(point.json());
    if (point.mean_strain <= target || !std::isfinite(point.mean_strain)) break;
    if (point.milliseconds > 1e3 * residual_budget / growth) break;
    if (point.milliseconds > 1e3 * repeated_below) growth = 2;
  }
  const bool reached = point.mean_strain <= target;
  if (reached) point = min_iterations(world, target, before, point);
  Json result = Json::object();
  result.set("target", rounded(target));
  result.set("start", rounded(start.mean_strain));
  result.set("start_energy", rounded(start.energy));
  result.set("reached", Json::of(reached));
  result.set("ms", reached ? rounded(point.milliseconds) : Json());
  result.set("iterations", Json::whole(point.iterations));
  result.set("curve", std::move(curve));
  return result;
}

void describe(const Settings& settings, Json& result) {
  result.set("solver", Json::of(name_in(solver_names, settings.solver.kind)));
  result.set("sweep", Json::of(name_in(sweep_names, settings.solver.sweep)));
  result.set("relaxation", Json::of(settings.solver.relaxation));
  result.set("chebyshev", Json::of(settings.solver.chebyshev));
  result.set("colors", Json::whole(settings.solver.colors));
  result.set("mode", Json::of(name_in(mode_names, settings.mode)));
  result.set("substeps", Json::whole(settings.substeps));
  result.set("iterations", Json::whole(settings.iterations));
}

}  // namespace

void measure_scene(const BenchScene& scene, const BenchOptions& options, Json& result) {
  Settings settings = options.settings;
  if (scene.prepare != nullptr) scene.prepare(settings);
  describe(settings, result);
  settings.measure_residuals = false;  // costs about one iteration a step, and is measured separately
  World world(settings);
  scene.build(world, options.size);
  const std::vector<double> rest = tet_edge_lengths(world);
  const double milliseconds = time_steps(world, scene.step, options, result);
  const std::size_t constraints = world.report().constraints;
  result.set("particles", count_json(world.report().particles));
  result.set("constraints", count_json(constraints));
  result.set("constraints_per_second", rounded(static_cast<double>(constraints) * settings.substeps *
                                               settings.iterations / (milliseconds * 1e-3)));
  result.set("max_strain", rounded(largest_strain(world, rest)));
  result.set("hash", hash_json(world.hash()));
  if (scene.counts_crossings) {
    std::size_t crossings = 0;  // edges through triangles of the same cloth
    for (const ObjectId object : world.objects()) crossings += world.count_crossings(object);
    result.set("crossings", count_json(crossings));
  }
  result.set("projections_per_second", time_projections(world));
  const std::string remark = world.time_solve(frame_time, settings.iterations).diagnostic;
  if (!remark.empty()) result.set("remark", Json::of(remark));
  if (options.residual) result.set("residual", time_to_residual(scene, options));
}

}  // namespace souple::app
