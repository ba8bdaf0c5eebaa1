#pragma once

#include "app/sweep/folder.h"

#include <cstdint>

namespace souple::app {

/// Simulates a run of a sweep on one thread and writes its result, unless it has one; waits while another process simulates
/// it. Returns an ExitCode: success; non_finite where the run diverged; bad_input where the scene could not be simulated;
/// interrupted, without a result. Throws WriteError.
int simulate_run(const Sweep& sweep, std::uint64_t run);

/// Whether another process simulates the run now.
bool is_running(const Sweep& sweep, std::uint64_t run);

}  // namespace souple::app
