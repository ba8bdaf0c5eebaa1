#include "app/bench.h"

#include "app/bench_scenes.h"
#include "app/commands.h"
#include "app/exit_codes.h"
#include "app/option_names.h"
#include "souple/error.h"
#include "souple/scene/nearest.h"
#include "souple/simd/instruction_set.h"
#include "souple/threads/threads.h"
#include "souple/version.h"

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <string>
#include <type_traits>
#include <vector>

#include <fmt/core.h>

namespace souple::app {

using scene_format::Json;

namespace {

constexpr Benchmark own_benchmarks[] = {
    {"dam-break", "a block of water collapses in a tank: steps of 2 ms, 5 iterations", "particles", 97336,
     1000, 4000000, measure_dam_break},
    {"surface", "the surface of a broken dam as a mesh, cells of a particle's radius",
     "approximate number of particles", 98000, 100, 5000000, measure_surface},
};

/// Calls `use` with each benchmark, in listing order: rows of two kinds with the same names of members.
template <class Use>
void for_each_benchmark(const Use& use) {
  for (const BenchScene& scene : bench_scenes()) use(scene);
  for (const Benchmark& benchmark : own_benchmarks) use(benchmark);
}

int list_benchmarks() {
  std::size_t widest = 0;
  for_each_benchmark([&](const auto& bench) { widest = std::max(widest, std::strlen(bench.name)); });
  for_each_benchmark([&](const auto& bench) {
    std::printf("%-*s  %s; --size: %s [%d]\n", static_cast<int>(widest), bench.name, bench.description,
                bench.size_means, bench.default_size);
  });
  return success;
}

/// Throws Error unless `name` is a benchmark.
void require_known(const std::string& name) {
  std::vector<std::string> names;
  for_each_benchmark([&](const auto& bench) { names.emplace_back(bench.name); });
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

BenchOptions options_of(const BenchRequest& request) {
  BenchOptions options;
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
  return options;
}

/// The entries that all results have.
template <class Bench>
Json begin_result(const Bench& bench, BenchOptions& options) {
  if (options.size == 0) options.size = bench.default_size;
  if (options.size < bench.min_size || options.size > bench.max_size)
    throw Error(fmt::format("--size {}: {} takes {} to {} {}", options.size, bench.name, bench.min_size,
                            bench.max_size, bench.size_means));
  Json result = Json::object();
  result.set("name", Json::of(bench.name));
  result.set("size", Json::whole(options.size));
  result.set("threads",
             Json::whole(make_threads(options.settings.threading, options.settings.threads)->count()));
  result.set("simd", Json::of(std::string(simd_name())));
  result.set("version", Json::of(version));
  result.set("warm_up", Json::whole(options.warm_up));
  result.set("runs", Json::whole(options.runs));
  return result;
}

Json measure(const std::string& name, BenchOptions options) {
  Json result;
  for_each_benchmark([&](const auto& bench) {
    if (name != bench.name) return;
    result = begin_result(bench, options);
    if constexpr (std::is_same_v<decltype(bench), const BenchScene&>) {
      measure_scene(bench, options, result);
    } else {
      if (options.residual) throw Error(fmt::format("--residual: {} uses no solver", name));
      bench.measure(options, result);
    }
  });
  return result;
}

}  // namespace

int bench(const BenchRequest& request) {
  if (request.name.empty()) return list_benchmarks();
  require_known(request.name);
  Json before;
  if (!request.compare.empty()) before = read_bench_json(request.compare);
  const bool compares = before.is(Json::Kind::object);
  try {
    Json now = measure(request.name, options_of(request));
    if (request.json) {
      if (compares) now.set("faster", speed_up(now, before));
      std::fputs(dump_json(now).c_str(), stdout);
    } else {
      print_bench(now, compares ? &before : nullptr);
    }
    return success;
  } catch (const NonFiniteError& error) {
    std::fprintf(stderr, "souple: %s: %s\n", request.name.c_str(), error.message.c_str());
    return non_finite;
  }
}

}  // namespace souple::app
