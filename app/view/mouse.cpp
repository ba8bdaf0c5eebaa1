#include "app/view/mouse.h"

#include "app/view/simulation.h"
#include "souple/host/grab.h"
#include "souple/objects/kind_traits.h"

#include <cmath>
#include <imgui.h>

namespace souple::viewer {

namespace {

constexpr float radians_per_unit = 0.008f;
constexpr float zoom_per_notch = 0.88f;

/// Mouse position in pixels of the area.
ImVec2 in_area(const ImVec2& at, const ViewArea& area) {
  return {at.x * area.scale - static_cast<float>(area.x), at.y * area.scale - static_cast<float>(area.y)};
}

host::Ray ray_under(const render::Camera& camera, const ViewArea& area, const ImVec2& mouse) {
  const ImVec2 at = in_area(mouse, area);
  const render::Ray ray = camera.ray(at.x, at.y, area.width, area.height);
  return {ray.origin, ray.direction};
}

}  // namespace

render::Ray ray_under_mouse(const render::Camera& camera, const ViewArea& area) {
  const auto width = static_cast<float>(area.width), height = static_cast<float>(area.height);
  ImVec2 at = in_area(ImGui::GetIO().MousePos, area);
  if (!(at.x >= 0 && at.x < width && at.y >= 0 && at.y < height)) at = {width / 2, height / 2};
  return camera.ray(at.x, at.y, area.width, area.height);
}

Mouse::Mouse() = default;
Mouse::~Mouse() = default;

void Mouse::release() {
  grab_.reset();
  plane_.reset();
  drag_ = Drag::none;
}

Vec3f Mouse::grabbed_point() const {
  return grab_ ? grab_->point() : drag_target();
}

Vec3f Mouse::drag_target() const {
  return plane_ ? plane_->point() : Vec3f{};
}

void Mouse::update(render::Camera& camera, Simulation* simulation, const ViewArea& area, const Pick& pick) {
  const ImGuiIO& io = ImGui::GetIO();
  if (area.empty()) return release();
  const bool held = ImGui::IsMouseDown(drag_ == Drag::pan ? 1 : 0);
  if (drag_ != Drag::none && !held) release();
  if (io.WantCaptureMouse && drag_ == Drag::none) return;
  press(camera, simulation, area, pick);
  drag(camera, area);
  if (io.MouseWheel != 0) camera.zoom(std::pow(zoom_per_notch, io.MouseWheel));
}

void Mouse::press(const render::Camera& camera, Simulation* simulation, const ViewArea& area,
                  const Pick& pick) {
  if (drag_ != Drag::none) return;
  if (ImGui::IsMouseClicked(1)) drag_ = Drag::pan;
  if (!ImGui::IsMouseClicked(0)) return;
  drag_ = Drag::orbit;
  const ImVec2 mouse = ImGui::GetIO().MouseClickedPos[0], at = in_area(mouse, area);
  const std::optional<PickedVertex> found = pick(static_cast<int>(at.x), static_cast<int>(at.y));
  if (!found || simulation == nullptr) return;
  drag_ = Drag::none;
  if (ImGui::IsMouseDoubleClicked(0)) {
    if (!traits_of(simulation->world().kind(found->object)).driven)
      simulation->toggle_pin(found->object, found->vertex);
    return;
  }
  grab_ = std::make_unique<Grab>(simulation->world(), found->object, found->vertex, found->point);
  if (!grab_->holds()) return grab_.reset();  // a pinned vertex cannot be grabbed
  plane_.emplace(found->point, ray_under(camera, area, mouse), camera.forward());
  drag_ = Drag::grab;
}

void Mouse::drag(render::Camera& camera, const ViewArea& area) {
  const ImGuiIO& io = ImGui::GetIO();
  const float dx = io.MouseDelta.x, dy = io.MouseDelta.y;
  switch (drag_) {
    case Drag::none:
      return;
    case Drag::orbit:
      return camera.orbit(-dx * radians_per_unit, dy * radians_per_unit);
    case Drag::pan:
      return camera.pan(dx * area.scale, dy * area.scale, area.height);
    case Drag::grab:
      grab_->move_to(plane_->drag(ray_under(camera, area, io.MousePos)));
  }
}

}  // namespace souple::viewer
