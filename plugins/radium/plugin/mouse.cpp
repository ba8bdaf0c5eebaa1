#include "plugins/radium/plugin/mouse.h"

#include <Core/Asset/Camera.hpp>
#include <Engine/Data/ViewingParameters.hpp>
#include <Engine/Rendering/Renderer.hpp>
#include <Gui/Viewer/CameraManipulator.hpp>
#include <Gui/Viewer/Viewer.hpp>
#include <QMouseEvent>
#include <exception>
#include <tuple>
#include <utility>

namespace souple::radium {

using Ra::Core::Vector2;
using Ra::Core::Vector3;
using Ra::Engine::Rendering::Renderer;
using Ra::Gui::Viewer;

namespace {

const Ra::Core::Asset::Camera& camera_of(Viewer& viewer) {
  return *viewer.getCameraManipulator()->getCamera();
}

/// Position in device pixels, from the top left.
Vector2 device_pixels(Viewer& viewer, const QPoint& at) {
  return viewer.toDevice({static_cast<float>(at.x()), static_cast<float>(at.y())});
}

}  // namespace

Mouse::Mouse(Viewer& viewer, PhysicsSystem& system, const BackSides& back_sides, Answers answers)
    : viewer_(viewer), system_(system), back_sides_(back_sides), answers_(std::move(answers)) {
  connect(&viewer, &Viewer::onMousePress, this, [this](QMouseEvent* event) { press(*event); });
  connect(&viewer, &Viewer::onMouseMove, this, [this](QMouseEvent* event) { move(*event); });
  connect(&viewer, &Viewer::onMouseRelease, this, [this](QMouseEvent* event) { release(*event); });
}

Ra::Core::Ray Mouse::ray(const QPoint& at) {
  return camera_of(viewer_).getRayFromScreen(device_pixels(viewer_, at));
}

std::optional<Mouse::Seen> Mouse::pick(const QPoint& at) {
  const auto& camera = camera_of(viewer_);
  const QPoint from_below(at.x(), viewer_.height() - at.y());
  const Renderer::PickingQuery query{device_pixels(viewer_, from_below), Renderer::SELECTION, Renderer::RO};
  Ra::Engine::Data::ViewingParameters view;
  view.viewMatrix = camera.getViewMatrix();
  view.projMatrix = camera.getProjMatrix();
  viewer_.makeCurrent();
  const Renderer::PickingResult result = viewer_.getRenderer()->doPickingNow(query, view);
  viewer_.doneCurrent();
  if (result.getRoIdx().isInvalid() || result.getIndices().empty()) return std::nullopt;

  const auto [triangle, corner, edge] = result.getIndices().front();
  (void)edge;
  const Vector2 pixel = device_pixels(viewer_, at);
  const Vector3 point = camera.unProjectFromScreen(Vector3(pixel.x(), pixel.y(), result.getDepth()));
  return Seen{back_sides_.front_of({result.getRoIdx(), triangle, corner}),
              (point - camera.getPosition()).norm()};
}

void Mouse::press(const QMouseEvent& event) {
  if (event.button() != Qt::RightButton) return;
  try {
    const std::optional<Seen> seen = pick(event.pos());
    if (seen && system_.object_of(seen->vertex.render_object) != 0)
      answers_.picked(system_.object_of(seen->vertex.render_object));
    if ((event.modifiers() & (Qt::ShiftModifier | Qt::ControlModifier)) != 0)
      set_pinned(seen, (event.modifiers() & Qt::ShiftModifier) != 0);
    else
      grab(seen, event.pos());
  } catch (const std::exception& error) {
    answers_.say(error.what());
  }
}

bool Mouse::grab(const std::optional<Seen>& seen, const QPoint& at) {
  const Ra::Core::Ray through = ray(at);
  const Vector3 facing = camera_of(viewer_).getDirection();
  if (seen && system_.grab(seen->vertex, through, facing)) return true;
  // Radium does not pick surfaces from behind. Souple does, but it does not know meshes outside its world:
  // one of them may be in front.
  if (!system_.grab(through, facing)) return false;
  const Vec3f held = system_.session().grabbed_point();
  const float distance = (Vector3(held.x, held.y, held.z) - camera_of(viewer_).getPosition()).norm();
  constexpr float slack = 1.01f;  // the grabbed vertex is beside the ray
  if (!seen || distance < slack * seen->distance) return true;
  system_.release();
  return false;
}

void Mouse::set_pinned(const std::optional<Seen>& seen, bool pinned) {
  if (!seen || !system_.set_pinned(seen->vertex, pinned)) return;
  answers_.say(pinned ? "a vertex is pinned; Ctrl + right click lets it go" : "a vertex is free");
  answers_.update();
}

void Mouse::move(const QMouseEvent& event) {
  if ((event.buttons() & Qt::RightButton) != 0) system_.drag(ray(event.pos()));
}

void Mouse::release(const QMouseEvent& event) {
  if (event.button() == Qt::RightButton) system_.release();
}

}  // namespace souple::radium
