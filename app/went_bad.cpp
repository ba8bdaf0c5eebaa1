#include "app/went_bad.h"

#include <fmt/core.h>

namespace souple::app {

std::string went_bad_text(const std::string& source, const StepReport& report, std::uint64_t frame) {
  return fmt::format(
      "{}: the simulation went bad in frame {}: object \"{}\", particle {} is no longer finite", source,
      frame, report.bad_object, report.bad_vertex);
}

}  // namespace souple::app
