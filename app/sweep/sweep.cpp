#include "app/commands.h"
#include "app/exit_codes.h"
#include "app/sweep/folder.h"
#include "app/sweep/one_run.h"
#include "app/sweep/pool.h"
#include "app/sweep/sheet.h"
#include "app/sweep/slurm.h"
#include "app/sweep/table.h"
#include "souple/error.h"
#include "souple/threads/thread_pool.h"

#include <chrono>
#include <cstdio>

#include <fmt/core.h>

namespace souple::app {

namespace {

/// The words of a command that does a part of this sweep, but for the part.
std::vector<std::string> arguments_for(const SweepRequest& request, const Sweep& sweep) {
  std::vector<std::string> words{"sweep", request.scene};
  for (const std::string& setting : request.settings) words.insert(words.end(), {"--set", setting});
  if (request.frames) words.insert(words.end(), {"--frames", fmt::format("{}", *request.frames)});
  for (const std::string& format : request.formats) words.insert(words.end(), {"--write", format});
  words.insert(words.end(), {"--out", sweep.out.string()});
  if (!request.sheet) words.emplace_back("--no-sheet");
  return words;
}

int list_runs(const Sweep& sweep) {
  for (std::uint64_t run = 1; run <= sweep.plan.runs(); ++run)
    std::printf("%04llu  %s\n", static_cast<unsigned long long>(run), sweep.plan.label_of(run).c_str());
  return success;
}

/// "24 runs, 2 diverged, 1 failed, 3 missing"
std::string counts_text(const Sweep& sweep, const SweepCounts& counts) {
  std::string text = fmt::format("{} runs", sweep.plan.runs());
  if (counts.diverged > 0) text += fmt::format(", {} diverged", counts.diverged);
  if (counts.failed > 0) text += fmt::format(", {} failed", counts.failed);
  if (counts.missing > 0) text += fmt::format(", {} missing", counts.missing);
  return text;
}

/// Writes what all runs share, and says so.
int gather(const Sweep& sweep, const std::string& time) {
  const SweepCounts counts = write_tables(sweep);
  const bool sheet = sweep.pictures && write_sheet(sweep);
  if (!sweep.quiet) {
    std::printf("%s: %s%s, in %s%s\n", sweep.name.c_str(), counts_text(sweep, counts).c_str(), time.c_str(),
                (sweep.out / table_name).string().c_str(),
                sheet ? fmt::format(" and {}", sheet_name).c_str() : "");
  }
  if (counts.diverged > 0) return non_finite;
  return counts.failed > 0 ? bad_input : success;
}

int simulate(const SweepRequest& request, const Sweep& sweep) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point start = Clock::now();
  std::vector<std::string> arguments = arguments_for(request, sweep);
  arguments.insert(arguments.begin(), "souple");
  if (request.quiet) arguments.emplace_back("--quiet");
  const auto processors = static_cast<std::uint32_t>(usable_processors());
  const int code = simulate_all(sweep, arguments, request.jobs.value_or(processors));
  const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
  const int of_runs = gather(sweep, fmt::format(" in {:.2f} s", seconds));
  if (code == interrupted)
    std::fputs("souple: interrupted; the same command does the runs that are missing\n", stderr);
  return code == success ? of_runs : code;
}

int simulate_only(const Sweep& sweep, std::uint64_t run) {
  if (run < 1 || run > sweep.plan.runs())
    throw Error(fmt::format("--only {}: expected the number of a run, 1 to {}", run, sweep.plan.runs()));
  return simulate_run(sweep, run);
}

int write_script(const SweepRequest& request, const Sweep& sweep) {
  write_slurm_script(request.slurm, sweep, arguments_for(request, sweep));
  if (!sweep.quiet) {
    std::printf("%s: %llu runs; start them with: sbatch %s\n", request.slurm.string().c_str(),
                static_cast<unsigned long long>(sweep.plan.runs()),
                shell_word(request.slurm.string()).c_str());
  }
  return success;
}

}  // namespace

int sweep(const SweepRequest& request) {
  const Sweep sweep(request);
  if (!request.only) sweep.check_all();
  if (request.dry_run) return list_runs(sweep);
  claim_folder(sweep);
  if (request.only) return simulate_only(sweep, *request.only);
  if (request.table) return gather(sweep, "");
  if (!request.slurm.empty()) return write_script(request, sweep);
  return simulate(request, sweep);
}

}  // namespace souple::app
