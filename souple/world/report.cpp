#include "souple/world/report.h"

namespace souple {

std::string_view stage_name(Stage stage) {
  constexpr std::array<std::string_view, stage_count> names{
      "broad_phase", "integrate", "fluids", "contacts", "solve", "finish", "velocity", "foam"};
  const auto index = static_cast<std::size_t>(stage);
  return index < names.size() ? names[index] : "?";
}

}  // namespace souple
