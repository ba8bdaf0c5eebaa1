#pragma once

#include "souple/stages/settings.h"

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

// Measurements of `souple bench`, as numbers; bench_report.h prints them.

namespace souple::app {

struct BenchOptions {
  std::string name;
  int size = 0;                    ///< 0: the scene's default
  Settings settings;               ///< substeps, solver, threads, ...
  int warm_up = 5;                 ///< steps before measurement starts
  int runs = 30;                   ///< steps measured
  std::optional<double> residual;  ///< mean strain to reach in the static case; its time is measured
};

/// Values by name, in order of first occurrence.
using NamedValues = std::vector<std::pair<std::string, double>>;

/// Convergence of a solver: strains and energy after some iterations, and the time these took.
struct CurvePoint {
  int iterations = 0;
  double milliseconds = 0;
  double mean_strain = 0, rms_strain = 0, largest_strain = 0;
  double energy = 0;  ///< 1/2 sum C^2 of the distances [J at 1 N/m]
};

/// Solve of the stretched cloth to a mean strain, without forces or velocities.
struct ResidualResult {
  double target = 0;
  double start = 0;                    ///< mean strain at the start
  double start_energy = 0;             ///< energy at the start, as in CurvePoint
  std::optional<double> milliseconds;  ///< time to the target; empty: not reached
  int iterations = 0;                  ///< iterations to the target
  std::vector<CurvePoint> curve;       ///< by number of iterations, each solved from scratch
};

struct BenchResult {
  std::string name;
  int size = 0, threads = 0;
  std::string simd;
  std::string solver, sweep, mode;
  double relaxation = 1, chebyshev = 0;
  int colors = 0;
  int substeps = 0, iterations = 0, warm_up = 0, runs = 0;
  std::size_t particles = 0, constraints = 0;
  double ms_per_step = 0;              ///< median of the runs, wall clock
  double ms_fastest = 0;               ///< fastest of the runs
  NamedValues ms_per_stage;            ///< median of each stage
  double constraints_per_second = 0;   ///< of the whole step: constraints * substeps * iterations / time
  NamedValues projections_per_second;  ///< per kind, projection alone
  double max_strain = 0;   ///< at the end: largest extension of a distance, a membrane or an edge of a tet
  std::uint64_t hash = 0;  ///< hash of the world at the end
  std::optional<std::size_t> crossings;  ///< at the end: edges through triangles of the same cloth
  std::string diagnostic;                ///< diagnostic message of the solver
  std::optional<ResidualResult> residual;
};

/// Throws Error for options that cannot be measured, NonFiniteError when a value became non-finite.
BenchResult measure(const BenchOptions& options);

/// Median of one or more values.
double median(std::vector<double> values);

/// The simulation produced a value that is not finite.
struct NonFiniteError {
  std::string message;
};

}  // namespace souple::app
