#include "app/bench_measure.h"
#include "app/bench_report.h"
#include "app/bench_scenes.h"
#include "app/bench_segments.h"
#include "app/bench_stages.h"
#include "app/bench_strain.h"
#include "app/commands.h"
#include "app/exit_codes.h"
#include "app/option_names.h"
#include "souple/error.h"
#include "souple/scene/nearest.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include <fmt/core.h>

namespace souple::app {

using scene_format::Json;

namespace {

int list_benchmarks() {
  std::size_t widest = 0;
  const auto name_length = [&](const auto& bench) { widest = std::max(widest, std::strlen(bench.name)); };
  const auto print = [&](const auto& bench) {
    std::printf("%-*s  %s; --size: %s [%d]\n", static_cast<int>(widest), bench.name, bench.description,
                bench.size_means, bench.default_size);
  };
  std::for_each(bench_scenes().begin(), bench_scenes().end(), name_length);
  std::for_each(stage_benches().begin(), stage_benches().end(), name_length);
  std::for_each(bench_scenes().begin(), bench_scenes().end(), print);
  std::for_each(stage_benches().begin(), stage_benches().end(), print);
  std::printf("%-*s  a segment against triangles, with each of the tests; --size: triangles [%d]\n",
              static_cast<int>(widest), segments_name, default_segments_size);
  return success;
}

/// Throws Error unless `name` is a benchmark: a scene, a stage or `segments`.
void require_known(const std::string& name) {
  std::vector<std::string> names;
  for (const BenchScene& scene : bench_scenes()) names.emplace_back(scene.name);
  for (const StageBench& stage : stage_benches()) names.emplace_back(stage.name);
  names.emplace_back(segments_name);
  if (std::find(names.begin(), names.end(), name) != names.end()) return;
  throw Error("unknown benchmark \"" + name + "\"" + scene_format::suggestion(name, names) +
              "; `souple bench` lists them");
}

/// Sets `value` to an option's number; throws Error when it is out of range.
void set_option(const std::optional<std::uint32_t>& given, const char* option, std::uint32_t min_value,
                std::uint32_t max_value, int& value) {
  if (!given) return;
  if (*given < min_value || *given > max_value)
    throw Error(fmt::format("{} {}: expected {} to {}", option, *given, min_value, max_value));
  value = static_cast<int>(*given);
}

SolverSettings solver_settings(const BenchRequest& request) {
  SolverSettings solver;
  if (!request.solver.empty()) solver.kind = value_of(solver_names, request.solver, "--solver");
  if (!request.sweep.empty()) solver.sweep = value_of(sweep_names, request.sweep, "--sweep");
  if (request.relaxation) solver.relaxation = *request.relaxation;
  if (request.chebyshev) solver.chebyshev = *request.chebyshev;
  set_option(request.colors, "--colors", 0, 64, solver.colors);
  return solver;
}

constexpr int strain_runs = 600;  // ten seconds: a strain that grows slowly shows

void set_strain(const BenchRequest& request, BenchOptions& options) {
  options.strain = request.strain;
  if (!options.strain) return;
  if (!(*options.strain > 0 && *options.strain <= 1))
    throw Error("--strain: expected a strain above 0 and at most 1, such as 0.02 for 2 %");
  if (request.substeps)
    throw Error("--substeps: --strain tries numbers of substeps; leave one of the two out");
  if (request.residual)
    throw Error("--residual: measures one solve, --strain steps; leave one of the two out");
  if (!request.runs) options.runs = strain_runs;
}

BenchOptions options_of(const BenchRequest& request) {
  BenchOptions options;
  options.name = request.name;
  Settings& settings = options.settings;
  settings.threads = 1;
  settings.solver = solver_settings(request);
  if (!request.mode.empty()) settings.mode = value_of(mode_names, request.mode, "--mode");
  if (!request.threading.empty())
    settings.threading = value_of(threading_names, request.threading, "--threading");
  set_option(request.size, "--size", 1, 100000000, options.size);
  set_option(request.threads, "--threads", 0, 1024, settings.threads);
  set_option(request.substeps, "--substeps", 1, 10000, settings.substeps);
  set_option(request.iterations, "--iterations", 1, 10000, settings.iterations);
  set_option(request.warm_up, "--warm-up", 0, 1000000, options.warm_up);
  set_option(request.runs, "--runs", 1, 1000000, options.runs);
  options.residual = request.residual;
  if (options.residual && !(*options.residual > 0 && *options.residual < 0.1))
    throw Error("--residual: expected a strain above 0 and below 0.1, the strain at the start");
  set_strain(request, options);
  return options;
}

/// `souple bench segments`: not a scene; takes only the options --size, --runs and --json.
int bench_segments(const BenchRequest& request) {
  if (request.strain) throw Error("--strain: segments uses no solver");
  if (!request.compare.empty()) throw Error("--compare: segments has no steps to compare");
  int size = default_segments_size, runs = 10;
  set_option(request.size, "--size", 1, 10000000, size);
  set_option(request.runs, "--runs", 1, 1000, runs);
  const auto result = segments_json(size, measure_segments(SegmentStack(size), runs));
  if (request.json) {
    std::fputs(dump_json(result).c_str(), stdout);
  } else {
    print_segments(result);
  }
  return success;
}

/// `souple bench NAME --strain`; prints each trial as it ends.
Json search(const BenchRequest& request) {
  static constexpr std::array by_default{SolverKind::automatic, SolverKind::gauss_seidel};
  const BenchOptions options = options_of(request);
  std::span<const SolverKind> solvers = by_default;
  if (!request.solver.empty()) solvers = {&options.settings.solver.kind, 1};
  const bool prints = !request.json;
  const StrainSearch found = search_strain(options, solvers, [prints](const StrainTrial& trial) {
    if (prints) print_trial(trial);
  });
  if (prints) print_cheapest(found);
  return strain_json(found, options);
}

Json measure(const BenchRequest& request, const StageBench* stage) {
  if (stage != nullptr) return measure_stage(*stage, options_of(request));
  return request.strain ? search(request) : bench_json(measure(options_of(request)));
}

}  // namespace

int bench(const BenchRequest& request) {
  if (request.name.empty()) return list_benchmarks();
  require_known(request.name);
  if (request.name == segments_name) return bench_segments(request);
  Json before;
  if (!request.compare.empty()) before = read_bench_json(request.compare);
  try {
    const StageBench* stage = find_stage_bench(request.name);
    Json now = measure(request, stage);
    const bool measured = now.find("ms_per_step") != nullptr;  // --strain may find no settings
    const bool compares = before.is(Json::Kind::object) && measured;
    if (request.json) {
      if (compares) now.set("faster", speed_up(now, before));
      std::fputs(dump_json(now).c_str(), stdout);
    } else if (stage != nullptr) {
      print_stage(now, compares ? &before : nullptr);
    } else if (measured) {
      print_bench(now, compares ? &before : nullptr);
    }
    return success;
  } catch (const NonFiniteError& error) {
    std::fprintf(stderr, "souple: %s: %s\n", request.name.c_str(), error.message.c_str());
    return non_finite;
  }
}

}  // namespace souple::app
