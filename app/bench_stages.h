#pragma once

#include "app/bench_measure.h"
#include "souple/scene/json.h"

#include <cstdint>
#include <span>
#include <string>
#include <vector>

// Benchmarks of single stages without a world: a table like the scenes of bench_scenes.h.

namespace souple::app {

struct StageBench {
  const char* name;
  const char* description;  ///< one line
  const char* size_means;   ///< meaning of --size
  int default_size;
  int least, most;  ///< useful sizes
  /// Runs the benchmark and returns its results; options.size is in range. Reads size, runs, warm_up and
  /// settings.threads of the options.
  scene_format::Json (*measure)(const BenchOptions& options);
};

/// All benchmarks, in the order of the list on screen.
std::span<const StageBench> stage_benches();

/// Null where there is no such benchmark.
const StageBench* find_stage_bench(const std::string& name);

/// Name, size, threads, instruction set and version, then the benchmark's results. Throws Error for a size
/// out of range.
scene_format::Json measure_stage(const StageBench& bench, BenchOptions options);

/// Prints the results; with `before`, if it is not nullptr, beside them.
void print_stage(const scene_format::Json& now, const scene_format::Json* before);

/// Crumpled sheets in motion: boxes, hash and near pairs.
scene_format::Json measure_triangles(const BenchOptions& options);

/// Random points in motion, in the order of their previous cells: cells and neighbor lists.
scene_format::Json measure_neighbors(const BenchOptions& options);

/// The surface of a broken dam: a mesh of its particles, with both kinds of kernels.
scene_format::Json measure_surface(const BenchOptions& options);

/// A dam break in a tank: steps of 2 ms with 5 iterations.
scene_format::Json measure_dam_break(const BenchOptions& options);

// Output of results by the benchmarks above.

/// The median; microseconds and less are noise.
scene_format::Json milliseconds(const std::vector<double>& values);
/// Sixteen digits.
scene_format::Json hash_json(std::uint64_t hash);

}  // namespace souple::app
