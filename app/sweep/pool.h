#pragma once

#include "app/sweep/folder.h"

#include <cstdint>
#include <string>
#include <vector>

namespace souple::app {

/// Simulates the runs that have no final result, each in a process of its own: this program with `arguments` and
/// `--only N`. At most `jobs` at a time; runs that another process simulates come last. Returns an ExitCode: success even
/// where runs diverged or failed; failed where a result could not be written; interrupted. Throws Error.
int simulate_all(const Sweep& sweep, const std::vector<std::string>& arguments, std::uint32_t jobs);

}  // namespace souple::app
