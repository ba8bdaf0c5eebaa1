#include "app/bench_strain.h"

#include "app/bench_report.h"
#include "app/bench_scenes.h"
#include "app/option_names.h"
#include "app/percent.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <limits>

namespace souple::app {

using scene_format::Json;

namespace {

constexpr std::array substeps_tried{1, 2, 3, 4, 6, 8, 10, 12, 16, 20, 30, 40, 60, 80, 120, 160, 240, 320};

StrainTrial trial_of(const BenchResult& result, double bound) {
  return {.solver = result.solver,
          .substeps = result.substeps,
          .steps = result.runs,
          .ms_per_step = result.ms_per_step,
          .ms_fastest = result.ms_fastest,
          .largest_strain = result.peak_strain,
          .within_bound = result.peak_strain <= bound};
}

Json trial_json(const StrainTrial& trial) {
  Json entry = Json::object();
  entry.set("solver", Json::of(trial.solver));
  entry.set("substeps", Json::whole(trial.substeps));
  entry.set("steps", Json::whole(trial.steps));
  entry.set("ms_per_step", rounded(trial.ms_per_step));
  entry.set("largest_strain", rounded(trial.largest_strain));
  entry.set("within_bound", Json::of(trial.within_bound));
  return entry;
}

}  // namespace

std::span<const int> substeps_to_try() {
  return substeps_tried;
}

StrainSearch search_strain(BenchOptions options, std::span<const SolverKind> solvers,
                           const std::function<void(const StrainTrial&)>& on_trial) {
  StrainSearch search;
  search.bound = *options.strain;
  for (const SolverKind solver : solvers) {
    options.settings.solver.kind = solver;
    for (const int substeps : substeps_tried) {
      options.settings.substeps = substeps;
      std::optional<BenchResult> result;
      StrainTrial trial{name_of(solver_names, solver), substeps};
      trial.largest_strain = std::numeric_limits<double>::infinity();
      try {
        result = measure(options);
        trial = trial_of(*result, search.bound);
      } catch (const NonFiniteError&) {  // more substeps may not diverge
      }
      search.trials.push_back(trial);
      on_trial(trial);
      const bool cheaper = !search.cheapest || trial.ms_per_step < search.cheapest->ms_per_step;
      if (trial.within_bound && cheaper) search.cheapest = std::move(result);
      if (trial.within_bound || (search.cheapest && trial.ms_fastest >= search.cheapest->ms_per_step)) break;
    }
  }
  return search;
}

Json strain_json(const StrainSearch& search, const BenchOptions& options) {
  Json object = Json::object();
  if (search.cheapest) {
    object = bench_json(*search.cheapest);
  } else {
    object.set("name", Json::of(options.name));
    object.set("size",
               Json::whole(options.size > 0 ? options.size : find_bench_scene(options.name).default_size));
  }
  Json strain = Json::object(), trials = Json::array();
  for (const StrainTrial& trial : search.trials) trials.items.push_back(trial_json(trial));
  strain.set("bound", rounded(search.bound));
  strain.set("reached", Json::of(search.cheapest.has_value()));
  if (search.cheapest) strain.set("largest", rounded(search.cheapest->peak_strain));
  strain.set("trials", std::move(trials));
  object.set("strain", std::move(strain));
  return object;
}

void print_trial(const StrainTrial& trial) {
  std::printf("%-20s %4d substeps  ", trial.solver.c_str(), trial.substeps);
  if (std::isfinite(trial.largest_strain)) {
    std::printf("%10.3f ms a step  %10s in %d steps%s\n", trial.ms_per_step,
                percent(trial.largest_strain).c_str(), trial.steps,
                trial.within_bound ? ": within the bound" : "");
  } else {
    std::printf("diverges\n");
  }
  std::fflush(stdout);
}

void print_cheapest(const StrainSearch& search) {
  if (search.cheapest) {
    const BenchResult& best = *search.cheapest;
    std::printf("cheapest with a strain of at most %g %%: %s, %d substeps, %.3g ms a step, strain %s\n",
                100 * search.bound, best.solver.c_str(), best.substeps, best.ms_per_step,
                percent(best.peak_strain).c_str());
    return;
  }
  std::printf(
      "no number of substeps up to %d keeps the strain within %g %%: allow more, if the material itself "
      "stretches, or try another --solver\n",
      substeps_tried.back(), 100 * search.bound);
}

}  // namespace souple::app
