#pragma once

#include "souple/io/manifest.h"
#include "souple/world/report.h"
#include "souple/world/settings.h"

#include <string>

namespace souple {

/// The settings of a world as the text of a JSON object, in the words of scene files.
std::string settings_text(const Settings& settings);

/// What run.json keeps of a step. `step` is 0 when nothing was simulated yet: then there are no values.
FrameReport frame_report(std::uint64_t frame, double time, const StepReport& report);

}  // namespace souple
