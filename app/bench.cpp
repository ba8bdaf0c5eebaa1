#include "app/bench.h"

#include "app/bench_scenes.h"
#include "app/commands.h"
#include "app/exit_codes.h"
#include "app/option_names.h"
#include "souple/error.h"
#include "souple/simd/instruction_set.h"
#include "souple/threads/threads.h"
#include "souple/version.h"

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <string>
#include <vector>

#include <fmt/core.h>

namespace souple::app {

using scene_format::Json;

namespace {

int list_benchmarks() {
  std::size_t widest = 0;
  for (const BenchScene& scene : bench_scenes()) widest = std::max(widest, std::strlen(scene.name));
  for (const BenchScene& scene : bench_scenes())
    std::printf("%-*s  %s; --size: %s [%d]\n", static_cast<int>(widest), scene.name, scene.description,
                scene.size_means, scene.default_size);
  return success;
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
  if (!request.solver.empty())
    solver.kind = value_of(option_values(solver_names), request.solver, "--solver");
  if (!request.sweep.empty()) solver.sweep = value_of(option_values(sweep_names), request.sweep, "--sweep");
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
  if (!request.mode.empty()) settings.mode = value_of(option_values(mode_names), request.mode, "--mode");
  if (!request.threading.empty())
    settings.threading = value_of(option_values(threading_names), request.threading, "--threading");
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

Json measure(const BenchScene& scene, BenchOptions options) {
  if (options.size == 0) options.size = scene.default_size;
  if (options.size < scene.min_size || options.size > scene.max_size)
    throw Error(fmt::format("--size {}: {} takes {} to {} {}", options.size, scene.name, scene.min_size,
                            scene.max_size, scene.size_means));
  Json result = Json::object();
  result.set("name", Json::of(scene.name));
  result.set("size", Json::whole(options.size));
  result.set("threads",
             Json::whole(make_threads(options.settings.threading, options.settings.threads)->count()));
  result.set("simd", Json::of(std::string(simd_name())));
  result.set("version", Json::of(version));
  result.set("warm_up", Json::whole(options.warm_up));
  result.set("runs", Json::whole(options.runs));
  measure_scene(scene, options, result);
  return result;
}

}  // namespace

int bench(const BenchRequest& request) {
  if (request.name.empty()) return list_benchmarks();
  const BenchScene& scene = find_bench_scene(request.name);
  Json before;
  if (!request.compare.empty()) before = read_bench_json(request.compare);
  const bool compares = before.is(Json::Kind::object);
  try {
    Json now = measure(scene, options_of(request));
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
