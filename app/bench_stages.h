#pragma once

#include "app/bench_measure.h"
#include "souple/scene/json.h"

#include <cstdint>
#include <span>
#include <string>
#include <vector>

// Benchmarks of one stage by itself, without a world: rows of a table like the scenes of bench_scenes.h.

namespace souple::app {

struct StageBench {
  const char* name;
  const char* description;  ///< one line
  const char* size_means;   ///< what --size counts
  int default_size;
  int least, most;  ///< sizes that make sense
  /// What it measured; options.size is in range. Reads size, runs, warm_up and settings.threads of the
  /// options.
  scene_format::Json (*measure)(const BenchOptions& options);
};

/// All of them, in the order in which they are listed.
std::span<const StageBench> stage_benches();

/// Null where there is no such benchmark.
const StageBench* find_stage_bench(const std::string& name);

/// Name, size, threads, instruction set and version, then what the benchmark measured. Throws Error for a
/// size out of range.
scene_format::Json measure_stage(const StageBench& bench, BenchOptions options);

/// For people; `before`, when there is one, beside it.
void print_stage(const scene_format::Json& now, const scene_format::Json* before);

/// Crumpled sheets in motion: boxes, hash and near pairs.
scene_format::Json measure_triangles(const BenchOptions& options);

/// Random points in motion, in the order of the cells they were in: cells and neighbor lists.
scene_format::Json measure_neighbors(const BenchOptions& options);

/// The surface of a broken dam: a mesh of its particles, by both kinds of kernels.
scene_format::Json measure_surface(const BenchOptions& options);

/// A block of water that falls apart in a tank: steps of 2 ms with 5 iterations.
scene_format::Json measure_dam_break(const BenchOptions& options);

// How the rows above write what they measured.

/// The median; microseconds and less are noise.
scene_format::Json milliseconds(const std::vector<double>& values);
/// Sixteen digits.
scene_format::Json hash_json(std::uint64_t hash);

}  // namespace souple::app
