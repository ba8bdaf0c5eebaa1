#include "souple/world/report.h"

namespace souple {

std::string_view stage_name(Stage stage) {
  switch (stage) {
    case Stage::broad_phase:
      return "broad_phase";
    case Stage::integrate:
      return "integrate";
    case Stage::fluids:
      return "fluids";
    case Stage::contacts:
      return "contacts";
    case Stage::solve:
      return "solve";
    case Stage::finish:
      return "finish";
    case Stage::velocity:
      return "velocity";
    case Stage::foam:
      return "foam";
  }
  return "?";
}

}  // namespace souple
