#pragma once

#include "souple/world/report.h"

#include <cstdint>
#include <string>

namespace souple::app {

/// "flag.json: the simulation diverged in frame 12: object "flag", particle 3 is no longer finite"
std::string non_finite_text(const std::string& source, const StepReport& report, std::uint64_t frame);

}  // namespace souple::app
