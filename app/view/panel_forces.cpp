#include "app/view/panels.h"
#include "app/view/widgets.h"

namespace souple::viewer {

namespace {

bool vec3_row(const char* name, const char* id, Vec3f& value, float speed, const char* unit) {
  float numbers[3]{value.x, value.y, value.z};
  if (!vector_row(name, id, numbers, speed, unit)) return false;
  value = {numbers[0], numbers[1], numbers[2]};
  return true;
}

}  // namespace

void forces_panel(Simulation& simulation) {
  if (!section("Gravity and wind")) return;
  Settings settings = simulation.scene().settings;
  bool changed = vec3_row("Gravity m/s\xc2\xb2", "##gravity", settings.gravity, 0.05f,
                          "Along X, Y (up) and Z. Drag to change, Ctrl + click to type.");
  changed |= vec3_row("Wind m/s", "##wind", settings.wind.velocity, 0.05f,
                      "Along X, Y (up) and Z. Drag to change, Ctrl + click to type.");
  changed |= slider_row("Gusts", "##gust", settings.wind.gust, {0, 1}, "",
                        "Relative variation of the wind's strength.");
  changed |= slider_row("Gust period", "##gust_period", settings.wind.gust_period, {0.1f, 20, true}, "s");
  changed |= slider_row("Air density", "##air_density", settings.wind.air_density, {0, 5}, "kg/m\xc2\xb3");
  changed |= slider_row("Drag", "##drag", settings.drag, {1e-3f, 100, true}, "1/s",
                        "Linear drag on every particle: force = -drag x mass x (velocity - wind).");
  if (changed) simulation.set_settings(settings);
}

}  // namespace souple::viewer
