#include "app/view/panels.h"
#include "app/view/widgets.h"

#include <imgui.h>

namespace souple::viewer {

void solver_panel(Simulation& simulation) {
  if (!section("Solver")) return;
  Settings settings = simulation.scene().settings;
  int mode = static_cast<int>(settings.mode), integrator = static_cast<int>(settings.integrator);
  bool changed =
      count_row("Substeps", "##substeps", settings.substeps, 1, 100,
                "Substeps of one frame. More are stiffer and more accurate, at proportional cost.");
  changed |= count_row("Iterations", "##iterations", settings.iterations, 1, 100,
                       "Iterations of the solver in each substep. More substeps are usually better.");
  changed |= choice_row("Mode", "##mode", mode, {"small steps", "XPBD", "PBD"},
                        "PBD uses stiffnesses from 0 to 1 instead of a material.");
  changed |= choice_row("Integrator", "##integrator", integrator,
                        {"semi-implicit", "explicit Euler", "implicit Euler"});
  if (!changed) return;
  settings.mode = static_cast<Mode>(mode);
  settings.integrator = static_cast<Integrator>(integrator);
  simulation.set_settings(settings);
}

}  // namespace souple::viewer
