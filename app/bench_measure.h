#pragma once

#include "souple/world/settings.h"

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

// What `souple bench` measures, as numbers; see bench_report.h for how they are shown.

namespace souple::app {

struct BenchOptions {
  std::string name;
  int size = 0;                    ///< 0: the scene's default
  Settings settings;               ///< substeps, solver, threads, ...
  int warm_up = 5;                 ///< steps before the first that counts
  int runs = 30;                   ///< steps that count
  std::optional<double> residual;  ///< time to this mean strain, static
};

/// Rates by name, in the order in which they were met.
using Named = std::vector<std::pair<std::string, double>>;

/// How far a solver has come, and how long that took.
struct CurvePoint {
  int iterations = 0;
  double milliseconds = 0;
  double mean_strain = 0, rms_strain = 0, largest_strain = 0;
};

/// Solving the stretched cloth to a mean strain, without forces or velocities.
struct ResidualResult {
  double target = 0;
  double start = 0;                    ///< mean strain before
  std::optional<double> milliseconds;  ///< to the target; nothing: it was not reached
  int iterations = 0;                  ///< that it took
  std::vector<CurvePoint> curve;       ///< from scratch each, by iterations
};

struct BenchResult {
  std::string name;
  int size = 0, threads = 0;
  std::string simd;
  std::string solver, sweep, form, mode;
  double relaxation = 1, chebyshev = 0;
  int colors = 0;
  int substeps = 0, iterations = 0, warm_up = 0, runs = 0;
  std::size_t particles = 0, constraints = 0;
  double ms_per_step = 0;             ///< median of the runs, wall clock
  double ms_fastest = 0;              ///< of the runs
  Named ms_per_stage;                 ///< median of each
  double constraints_per_second = 0;  ///< of the whole step: constraints * substeps * iterations / time
  Named projections_per_second;       ///< per kind, projection alone
  double max_strain = 0;              ///< at the end: longest extension of a distance or of an edge of a tet
  std::uint64_t hash = 0;             ///< of the world at the end
  std::string diagnostic;             ///< of the solver
  std::optional<ResidualResult> residual;
};

/// Throws Error for what cannot be measured, GoneBad when numbers stopped being finite.
BenchResult measure(const BenchOptions& options);

/// Of one number or more.
double median(std::vector<double> values);

/// The simulation gave numbers that are not finite.
struct GoneBad {
  std::string message;
};

}  // namespace souple::app
