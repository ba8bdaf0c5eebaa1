#include "app/view/simulation.h"
#include "app/view/ui.h"
#include "app/view/viewer.h"
#include "app/view/widgets.h"
#include "souple/error.h"

#include <algorithm>
#include <imgui.h>
#include <string>
#include <utility>

#include <fmt/core.h>

// Balls that are thrown, and objects that are added to a running scene.

namespace souple::viewer {

Simulation& Viewer::simulation_for(const char* what) {
  Simulation* const shown = simulation();
  if (shown == nullptr) throw Error(fmt::format("a recording cannot be changed; {} in a scene", what));
  return *shown;
}

/// Where the ray under the mouse meets the scene; far from it, the point at the distance of the camera's target.
Vec3f Viewer::point_under_mouse() {
  const render::Ray ray = ray_under_mouse(camera_, area_);
  const World& world = simulation_for("add objects").world();
  const double far = 4 * static_cast<double>(camera_.distance());
  const Hit hit = world.ray_cast(ray.origin, ray.direction, far);
  return hit.found ? hit.point : ray.origin + ray.direction * camera_.distance();
}

/// So that it meets the point under the mouse.
void Viewer::throw_ball() {
  Simulation& shown = simulation_for("throw balls");
  const render::Ray ray = ray_under_mouse(camera_, area_);
  const Vec3f from = ray.origin + ray.direction * (2 * ball_.radius);
  const Hit nearest = shown.world().closest_point(from);
  if (nearest.found && nearest.distance < static_cast<double>(ball_.radius)) {
    throw Error(
        fmt::format("the camera has no room for a ball of radius {:.3g} m; move the camera away, or make the "
                    "ball smaller in the panel",
                    ball_.radius));
  }
  const Vec3f direction = aim(from, point_under_mouse(), ball_.speed, shown.scene().settings.gravity);
  shown.add(thrown(ball_, from, direction), true);
  notices_.info(
      fmt::format("ball: radius {:.3g} m, {:.3g} kg, {:.3g} m/s", ball_.radius, ball_.mass, ball_.speed));
}

void Viewer::ask_addition() {
  addition_point_ = point_under_mouse();
  addition_asked_ = true;
}

void Viewer::add(const NewObject& object, const Vec3f& point) {
  Simulation& shown = simulation_for("add objects");
  const ObjectId added = shown.add(placed_above(point, shown.world(), object));
  chosen_object_ = shown.index_of(added);
  notices_.info(fmt::format("added {}: {}, {:.3g} kg", shown.world().name(added),
                            kind_name(shown.world().kind(added)), shown.world().total_mass(added)));
}

void Viewer::draw_add_menu() {
  if (std::exchange(addition_asked_, false)) ImGui::OpenPopup("##add");
  if (!ImGui::BeginPopup("##add")) return;
  ImGui::TextDisabled("Add here");
  for (const Addition addition : all_additions) {
    if (!ImGui::Selectable(label(addition))) continue;
    guarded([&] { add(described(addition, static_cast<double>(addition_size_)), addition_point_); });
  }
  ImGui::EndPopup();
}

void Viewer::additions_section() {
  if (!section("Throw and add", false)) return;
  const float view = camera_.distance();
  slider_row("Ball radius", "##ball_radius", ball_.radius, {view / 400, view / 4, true}, "m",
             "Key T throws it.");
  slider_row("Ball mass", "##ball_mass", ball_.mass, {1e-6f, 1e4f, true}, "kg");
  slider_row("Ball speed", "##ball_speed", ball_.speed, {0.1f, 100, true}, "m/s");
  slider_row("Object size", "##addition_size", addition_size_, {view / 100, view, true}, "m",
             "Key A adds an object of this size at the cursor.");
}

/// Each state that is kept; the right end is the present.
void Viewer::rewind_row(Simulation& simulation) {
  const int last = static_cast<int>(simulation.state_count()) - 1;
  int shown = static_cast<int>(simulation.state());
  const double back = simulation.state_time(simulation.state_count() - 1) - simulation.time();
  const std::string text =
      shown < last ? fmt::format("{:.2f} s back", back)
                   : fmt::format("now, {:.2f} s to go back", simulation.time() - simulation.state_time(0));
  ImGui::SetNextItemWidth(-1);
  if (!ImGui::SliderInt("##rewind", &shown, 0, last, text.c_str(), ImGuiSliderFlags_NoInput)) return;
  mouse_.release();
  simulation.rewind(static_cast<std::size_t>(std::clamp(shown, 0, last)));
}

}  // namespace souple::viewer
