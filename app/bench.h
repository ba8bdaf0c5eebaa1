#pragma once

#include "souple/scene/json.h"
#include "souple/stages/settings.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

// `souple bench`: measurements are a JSON object; bench_report.cpp prints and compares them.

namespace souple::app {

struct BenchScene;

struct BenchOptions {
  int size = 0;                    ///< 0: the benchmark's default
  Settings settings;               ///< substeps, solver, threads, ...
  int warm_up = 5;                 ///< steps before measurement starts
  int runs = 30;                   ///< steps measured
  std::optional<double> residual;  ///< mean strain to reach in the static case; its time is measured
};

/// The simulation produced a value that is not finite.
struct NonFiniteError {
  std::string message;
};

/// Steps of a scene, the projection of each kind, and the solve to a residual if asked for. Throws Error for options that cannot
/// be measured, NonFiniteError when a value became non-finite.
void measure_scene(const BenchScene& scene, const BenchOptions& options, scene_format::Json& result);

// --- numbers

/// Median of one or more values.
double median(std::vector<double> values);
/// Rounds to six digits, the precision of the measurements; null: not finite.
scene_format::Json rounded(double value);
scene_format::Json count_json(std::size_t count);
/// As sixteen hexadecimal digits.
scene_format::Json hash_json(std::uint64_t hash);

// --- report

/// Reads a result that --json printed. Throws Error when the file is not such a result.
scene_format::Json read_bench_json(const std::filesystem::path& file);
/// Speed-up of `now` over `before` for each number: above 1 is faster.
scene_format::Json speed_up(const scene_format::Json& now, const scene_format::Json& before);
/// Prints a table for people; with `before`, if not null, ratios beside it.
void print_bench(const scene_format::Json& now, const scene_format::Json* before);

}  // namespace souple::app
