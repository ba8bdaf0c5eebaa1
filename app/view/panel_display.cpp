#include "app/view/panels.h"
#include "app/view/widgets.h"

#include <string>
#include <vector>

#include <fmt/core.h>

namespace souple::viewer {

namespace {

/// Names as on the command line, with the key that selects each.
template <class Value, class Name>
std::vector<std::string> names_of(std::size_t count, Name name, bool numbered) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < count; ++i) {
    const std::string text(name(static_cast<Value>(i)));
    names.push_back(numbered ? fmt::format("{}  {}", i + 1, text) : text);
  }
  return names;
}

std::vector<const char*> pointers(const std::vector<std::string>& names) {
  std::vector<const char*> list;
  list.reserve(names.size());
  for (const std::string& name : names) list.push_back(name.c_str());
  return list;
}

void liquid_rows(render::DisplayOptions& display, render::RenderOptions& rendering) {
  const auto shapes =
      names_of<render::SplatShape>(render::splat_shape_count, render::splat_shape_name, false);
  int shape = static_cast<int>(display.liquid_splats);
  if (choice_row("Liquid splats", "##liquid_splats", shape, pointers(shapes),
                 "Shape of each particle of a fluid. Ellipsoids are smoother but slower."))
    display.liquid_splats = static_cast<render::SplatShape>(shape);
  const auto filters =
      names_of<render::LiquidFilter>(render::liquid_filter_count, render::liquid_filter_name, false);
  int filter = static_cast<int>(rendering.liquid_filter);
  if (choice_row("Liquid filter", "##liquid_filter", filter, pointers(filters),
                 "How the surface of fluids is smoothed on screen.")) {
    rendering.liquid_filter = static_cast<render::LiquidFilter>(filter);
    rendering.liquid_steps = 0;
  }
  if (rendering.liquid_filter == render::LiquidFilter::none) return;
  const bool flow = rendering.liquid_filter == render::LiquidFilter::curvature_flow;
  count_row("Filter steps", "##liquid_steps", rendering.liquid_steps, 0, flow ? 200 : 8,
            flow ? "Steps of curvature flow; 0 is 40." : "Passes of the narrow-range filter; 0 is 2.");
}

}  // namespace

void display_panel(render::DisplayOptions& display, render::RenderOptions& rendering, bool& half_resolution,
                   bool has_world, bool has_fluids) {
  if (!section("Display")) return;
  const auto displays = names_of<render::Display>(render::display_count, render::display_name, true);
  int shown = static_cast<int>(display.display);
  if (choice_row("Mode", "##display", shown, pointers(displays)))
    display.display = static_cast<render::Display>(shown);
  if (has_world) {
    const auto kinds = names_of<render::ConstraintDisplay>(render::constraint_display_count,
                                                           render::constraint_display_name, false);
    int constraints = static_cast<int>(display.constraints);
    if (choice_row("Constraints", "##constraints", constraints, pointers(kinds)))
      display.constraints = static_cast<render::ConstraintDisplay>(constraints);
  }
  slider_row("Hottest strain", "##largest_strain", display.max_strain, {0.001f, 1, true}, "",
             "The strain that the warmest color shows; 0.1 is 10 %.");
  slider_row("Hottest speed", "##largest_speed", display.max_speed, {0.01f, 100, true}, "m/s");
  check_row("Wireframe", "##wireframe", display.wireframe);
  check_row("Pins", "##pins", display.pins);
  check_row("Colliders", "##colliders", display.colliders);
  check_row("Shadows", "##shadows", rendering.shadows);
  check_row("Occlusion", "##occlusion", rendering.ambient_occlusion);
  if (has_fluids) liquid_rows(display, rendering);
  check_row("Half resolution", "##half_resolution", half_resolution);
}

}  // namespace souple::viewer
