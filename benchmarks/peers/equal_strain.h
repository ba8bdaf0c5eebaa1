#pragma once

#include "souple/scene/json.h"

namespace souple::peers {

struct EqualStrainOptions {
  int size = 200;                 ///< vertices along a side of the cloth
  int frames = 240;               ///< of a trial
  double max_milliseconds = 250;  ///< settings that take longer per frame are not tried
  bool prints = true;
};

/// For each engine, the cheapest setting with which the benchmark `cloth` keeps its largest strain within a bound:
/// hanging at rest within 2 % during the last second, pushed and swinging within 5 % in each frame but the first two.
/// The engines with these settings are then timed in turn, Souple with one thread and with two. An engine that does
/// not stay within the bound appears with the setting that comes nearest.
scene_format::Json compare_at_equal_strain(const EqualStrainOptions& options);

}  // namespace souple::peers
