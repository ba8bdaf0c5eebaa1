#include "app/bench_measure.h"

#include "app/bench_scenes.h"
#include "app/option_names.h"
#include "souple/simd/instruction_set.h"
#include "souple/world/debug_draw.h"
#include "souple/world/profile.h"
#include "souple/world/world.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>

#include <fmt/core.h>

namespace souple::app {

namespace {

using Clock = std::chrono::steady_clock;

constexpr double frame = 1.0 / 60;          // s, of every step
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

/// Runs one step; throws NonFiniteError, or Error where a callback failed.
const StepReport& step(World& world) {
  const StepReport& report = world.step(frame);
  if (!report.ok()) throw NonFiniteError{report.message};
  if (report.has(Flag::callback_failed)) throw Error(report.message);
  return report;
}

void time_steps(World& world, const BenchOptions& options, BenchResult& result) {
  const std::vector<double> rest = tet_edge_lengths(world);
  for (int i = 0; i < options.warm_up; ++i) step(world);
  std::vector<double> whole;
  std::array<std::vector<double>, stage_count> stages;
  for (int i = 0; i < options.runs; ++i) {
    const auto start = Clock::now();
    const StepReport& report = step(world);
    const std::chrono::duration<double, std::milli> spent = Clock::now() - start;
    whole.push_back(spent.count());
    for (std::size_t s = 0; s < stage_count; ++s) stages[s].push_back(report.milliseconds[s]);
  }
  result.runs = static_cast<int>(whole.size());
  result.max_strain = largest_strain(world, rest);
  result.ms_per_step = median(whole);
  result.ms_fastest = *std::min_element(whole.begin(), whole.end());
  double sum = 0;
  for (std::size_t s = 0; s < stage_count; ++s) {
    result.ms_per_stage.emplace_back(stage_name(static_cast<Stage>(s)), median(stages[s]));
    sum += result.ms_per_stage.back().second;
  }
  result.ms_per_stage.emplace_back("other", std::max(0.0, result.ms_per_step - sum));
}

void time_projections(World& world, BenchResult& result) {
  double once = 0;
  for (const KindTime& kind : world.time_projections(frame, 3)) once += kind.seconds;
  const int sweeps = static_cast<int>(std::clamp(projection_budget / std::max(once, 1e-9), 5.0, 2000.0));
  // Per kind: number of constraints, and seconds.
  std::vector<std::pair<std::string, std::pair<double, double>>> kinds;
  for (const KindTime& time : world.time_projections(frame, sweeps)) {
    const std::string name(time.kind);
    auto kind = std::find_if(kinds.begin(), kinds.end(), [&](const auto& k) { return k.first == name; });
    if (kind == kinds.end()) kind = kinds.insert(kinds.end(), {name, {0, 0}});
    kind->second.first += static_cast<double>(time.count);
    kind->second.second += time.seconds;
  }
  for (const auto& [name, total] : kinds)
    result.projections_per_second.emplace_back(name, total.first / std::max(total.second, 1e-12));
}

CurvePoint solve(World& world, int iterations) {
  SolveTime best = world.time_solve(frame, iterations);
  for (int again = 0; again < 2 && best.seconds < repeated_below; ++again)
    best.seconds = std::min(best.seconds, world.time_solve(frame, iterations).seconds);
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

/// Each iteration count is solved from scratch, so acceleration over iterations has the effect that it has in
/// use.
ResidualResult time_to_residual(const BenchScene& scene, const BenchOptions& options, int size) {
  Settings settings = options.settings;
  settings.gravity = {};
  World world(settings);
  scene.build(world, size);
  stretch_cloths(world, stretched);
  ResidualResult result;
  result.target = *options.residual;
  world.time_solve(frame, 1);  // excludes what the first solve prepares
  CurvePoint before = solve(world, 0), point = before;
  result.start = before.mean_strain;
  result.start_energy = before.energy;
  double growth = std::sqrt(2.0);
  for (int n = 1; n <= max_iterations; n = std::max(n + 1, static_cast<int>(n * growth))) {
    before = point;
    point = solve(world, n);
    result.curve.push_back(point);
    if (point.mean_strain <= result.target || !std::isfinite(point.mean_strain)) break;
    if (point.milliseconds > 1e3 * residual_budget / growth) break;
    if (point.milliseconds > 1e3 * repeated_below) growth = 2;
  }
  if (point.mean_strain <= result.target) {
    point = min_iterations(world, result.target, before, point);
    result.milliseconds = point.milliseconds;
  }
  result.iterations = point.iterations;
  return result;
}

void describe(const BenchOptions& options, BenchResult& result) {
  const Settings& s = options.settings;
  result.threads = s.threads > 0 ? s.threads : make_threads(s.threading, 0)->count();
  result.simd = simd_name();
  result.solver = name_of(solver_names, s.solver.kind);
  result.sweep = name_of(sweep_names, s.solver.sweep);
  result.mode = name_of(mode_names, s.mode);
  result.relaxation = static_cast<double>(s.solver.relaxation);
  result.chebyshev = static_cast<double>(s.solver.chebyshev);
  result.colors = s.solver.colors;
  result.substeps = s.substeps;
  result.iterations = s.iterations;
  result.warm_up = options.warm_up;
}

}  // namespace

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t middle = values.size() / 2;
  return values.size() % 2 == 1 ? values[middle] : (values[middle - 1] + values[middle]) / 2;
}

BenchResult measure(const BenchOptions& options) {
  const BenchScene& scene = find_bench_scene(options.name);
  BenchResult result;
  result.name = scene.name;
  result.size = options.size > 0 ? options.size : scene.default_size;
  if (result.size < scene.min_size || result.size > scene.max_size)
    throw Error(fmt::format("--size {}: {} takes {} to {} {}", result.size, scene.name, scene.min_size,
                            scene.max_size, scene.size_means));
  describe(options, result);
  Settings settings = options.settings;
  settings.measure_residuals = false;  // costs about one iteration a step, and is measured separately
  World world(settings);
  scene.build(world, result.size);
  time_steps(world, options, result);
  result.particles = world.report().particles;
  result.constraints = world.report().constraints;
  result.constraints_per_second = static_cast<double>(result.constraints) * result.substeps *
                                  result.iterations / (result.ms_per_step * 1e-3);
  result.hash = world.hash();
  if (scene.counts_crossings) {
    result.crossings = 0;
    for (const ObjectId object : world.objects()) *result.crossings += world.count_crossings(object);
  }
  time_projections(world, result);
  result.diagnostic = world.time_solve(frame, result.iterations).diagnostic;
  if (options.residual) result.residual = time_to_residual(scene, options, result.size);
  return result;
}

}  // namespace souple::app
