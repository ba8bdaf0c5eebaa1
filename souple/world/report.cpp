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

std::string_view advice(Flag flag) {
  switch (flag) {
    case Flag::non_finite:
      return "a position or velocity is not finite; the last valid state was restored: raise substeps, "
             "lower the stiffness, or check for extreme masses and forces";
    case Flag::large_strain:
      return "an edge or a membrane is stretched by more than 10 %: raise substeps; a higher stiffness helps "
             "only "
             "where the solver reaches that of the material";
    case Flag::deep_contact:
      return "a contact is deeper than the largest thickness after the step: raise substeps or the thickness";
    case Flag::callback_failed:
      return "a callback threw an exception: its effect was left out";
    case Flag::intersecting:
      return "surfaces pass through each other and are being separated as far as they can move: start "
             "without intersections, drive them apart, or disable collision between them";
    case Flag::coarse_substeps:
      return "a fluid moves by more than a third of its spacing in a substep, or its depth and pressure "
             "allow such a motion: raise substeps or the spacing";
    case Flag::not_converged:
      return "the solver has not converged, so the material appears too soft: raise substeps, or use the "
             "solver "
             "automatic";
  }
  return "?";
}

}  // namespace souple
