#include "app/went_bad.h"

namespace souple::app {

std::string went_bad_text(const std::string& source, const StepReport& report, std::uint64_t frame) {
  return source + ": the simulation went bad in frame " + std::to_string(frame) + ": object \"" +
         report.bad_object + "\", particle " + std::to_string(report.bad_vertex) + " is no longer finite";
}

}  // namespace souple::app
