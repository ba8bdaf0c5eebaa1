#pragma once

#include "souple/world/settings.h"

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

// Measurements of `souple bench`; bench_report.h prints them.

namespace souple::app {

struct BenchOptions {
  std::string name;
  int size = 0;                    ///< 0: the scene's default
  Settings settings;               ///< substeps, solver, threads, ...
  int warm_up = 5;                 ///< steps before the measurement
  int runs = 30;                   ///< measured steps
  std::optional<double> residual;  ///< time to this mean strain, static
};

/// Named rates, in order of first occurrence.
using Named = std::vector<std::pair<std::string, double>>;

/// Progress of a solver after a duration.
struct CurvePoint {
  int iterations = 0;
  double milliseconds = 0;
  double mean_strain = 0, rms_strain = 0, largest_strain = 0;
};

/// Time to solve the stretched cloth to a mean strain, without forces or velocities.
struct ResidualResult {
  double target = 0;
  double start = 0;                    ///< initial mean strain
  std::optional<double> milliseconds;  ///< time to the target; empty: not reached
  int iterations = 0;                  ///< iterations to the target
  std::vector<CurvePoint> curve;       ///< by iterations; each point is a run of its own
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
  double ms_fastest = 0;              ///< fastest run
  Named ms_per_stage;                 ///< median per stage
  double constraints_per_second = 0;  ///< whole step: constraints * substeps * iterations / time
  Named projections_per_second;       ///< per kind, without the rest of the step
  double max_strain = 0;              ///< at the end: largest strain of a distance or of an edge of a tet
  std::uint64_t hash = 0;             ///< hash of the final world
  std::string diagnostic;             ///< diagnostic of the solver
  std::optional<ResidualResult> residual;
};

/// Throws Error for options that cannot be measured, NonFinite if the simulation diverged.
BenchResult measure(const BenchOptions& options);

/// Median of one number or more.
double median(std::vector<double> values);

/// The simulation gave numbers that are not finite.
struct NonFinite {
  std::string message;
};

}  // namespace souple::app
