#include "app/non_finite.h"

#include <fmt/core.h>

namespace souple::app {

std::string non_finite_text(const std::string& source, const StepReport& report, std::uint64_t frame) {
  return fmt::format(
      "{}: the simulation diverged in frame {}: object \"{}\", particle {} is no longer finite", source,
      frame, report.bad_object, report.bad_vertex);
}

}  // namespace souple::app
