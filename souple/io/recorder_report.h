#pragma once

#include "souple/io/manifest.h"
#include "souple/stages/settings.h"
#include "souple/world/report.h"

#include <string>

namespace souple {

/// The settings of a world as the text of a JSON object, with the keys of scene files.
std::string settings_text(const Settings& settings);

/// The step report for run.json. Before the first step (`step` = 0) it has no values.
FrameReport frame_report(std::uint64_t frame, double time, const StepReport& report);

}  // namespace souple
