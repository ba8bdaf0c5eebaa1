#pragma once

#include "app/bench_measure.h"
#include "souple/scene/json.h"

#include <cstdint>
#include <span>
#include <string>
#include <vector>

// Benchmarks of `souple bench` with measurements of their own: rows of a table like the scenes of bench_scenes.h.

namespace souple::app {

struct StageBench {
  const char* name;
  const char* description;  ///< one line
  const char* size_means;   ///< meaning of --size
  int default_size;
  int min_size, max_size;  ///< range of --size
  /// Returns the measurements. options.size must be in range. Reads size, runs, warm_up and settings.threads
  /// of the options.
  scene_format::Json (*measure)(const BenchOptions& options);
};

/// All stage benchmarks, in listing order.
std::span<const StageBench> stage_benches();

/// Null if there is no benchmark with this name.
const StageBench* find_stage_bench(const std::string& name);

/// Name, size, threads, instruction set and version, followed by the benchmark's measurements. Throws Error
/// for a size out of range.
scene_format::Json measure_stage(const StageBench& bench, BenchOptions options);

/// Prints a table for people; with `before`, if not null, beside it.
void print_stage(const scene_format::Json& now, const scene_format::Json* before);

/// The surface of a broken dam: a mesh of its particles, with both kinds of kernels.
scene_format::Json measure_surface(const BenchOptions& options);

/// A block of water that collapses in a tank: steps of 2 ms with 5 iterations.
scene_format::Json measure_dam_break(const BenchOptions& options);

// Helpers with which the benchmarks above write their measurements.

/// The median; differences of microseconds are noise.
scene_format::Json milliseconds(const std::vector<double>& values);
/// As sixteen hexadecimal digits.
scene_format::Json hash_json(std::uint64_t hash);

}  // namespace souple::app
