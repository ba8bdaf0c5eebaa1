#pragma once

#include "app/sweep/folder.h"
#include "souple/io/manifest.h"

#include <cstdint>
#include <optional>
#include <string>

namespace souple::app {

/// Result of a run of a sweep: 0007/result.json, a row of the table.
struct RunResult {
  enum class Status {
    finished,
    diverged,  ///< a value became non-finite: exit code non_finite of `souple run`
    failed,    ///< the scene could not be built or simulated; the next start repeats the run
    missing    ///< not run yet
  };
  Status status = Status::missing;
  std::string error;         ///< a sentence; empty when finished
  std::uint64_t frames = 0;  ///< simulated
  std::string hash;          ///< World::hash of the last state
  /// Largest strain and deepest contact of all frames, other values of the last step's report.
  NamedNumbers values;
  double seconds = 0;  ///< of wall clock

  /// Whether a later start of the command leaves the run as it is.
  bool is_final() const { return status == Status::finished || status == Status::diverged; }
};

const char* status_name(RunResult::Status status);

/// Writes 0007/result.json atomically. Throws Error.
void write_result(const Sweep& sweep, std::uint64_t run, const RunResult& result);
/// `missing` where there is none of this sweep, or it is damaged.
RunResult read_result(const Sweep& sweep, std::uint64_t run);

}  // namespace souple::app
