#pragma once

#include "app/bench_measure.h"
#include "souple/scene/json.h"

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

// `souple bench NAME --strain`: the cheapest settings that keep the largest strain of a scene within a bound.

namespace souple::app {

/// One number of substeps of one solver.
struct StrainTrial {
  std::string solver;
  int substeps = 0;
  int steps = 0;              ///< measured; fewer than asked for where the bound was exceeded
  double ms_per_step = 0;     ///< median of these steps
  double ms_fastest = 0;      ///< fastest of these steps
  double largest_strain = 0;  ///< the largest after any of these steps; infinite: the simulation diverged
  bool within_bound = false;
};

struct StrainSearch {
  double bound = 0;
  std::vector<StrainTrial> trials;
  std::optional<BenchResult> cheapest;  ///< of the trials within the bound; empty: there is none
};

/// Numbers of substeps that are tried, ascending.
std::span<const int> substeps_to_try();

/// Measures the benchmark with more and more substeps of each solver. It ends when the largest strain after any of
/// options.runs steps is within *options.strain, or every step costs more than with the cheapest settings found.
/// `on_trial` receives each trial. Throws Error for options that cannot be measured.
StrainSearch search_strain(BenchOptions options, std::span<const SolverKind> solvers,
                           const std::function<void(const StrainTrial&)>& on_trial);

/// The result of the cheapest settings as bench_json gives it, with "strain": the bound and all trials. If no settings
/// are within the bound, it has the benchmark's name and size.
scene_format::Json strain_json(const StrainSearch& search, const BenchOptions& options);

void print_trial(const StrainTrial& trial);
/// One sentence.
void print_cheapest(const StrainSearch& search);

}  // namespace souple::app
