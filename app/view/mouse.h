#pragma once

#include "app/view/session.h"
#include "render/camera.h"
#include "souple/host/drag_plane.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>

namespace souple {
class Grab;
}

namespace souple::viewer {

class Simulation;

/// The part of the window that shows the scene. [pixels, from the upper left corner]
struct ViewArea {
  int x = 0, y = 0, width = 0, height = 0;
  float scale = 1;  ///< pixels per unit of the mouse's coordinates

  bool empty() const { return width < 1 || height < 1; }
};

/// The ray under the mouse; through the center where the mouse is not over the area.
render::Ray ray_under_mouse(const render::Camera& camera, const ViewArea& area);

/// Mouse actions in the scene: grabbing objects, pinning particles, moving the camera.
class Mouse {
 public:
  /// The vertex of an object under the mouse.
  struct PickedVertex {
    ObjectId object;
    std::uint32_t vertex = 0;
    Vec3f point{};  ///< m
  };
  /// Finds the vertex under a pixel of the area; empty where there is no object.
  using Pick = std::function<std::optional<PickedVertex>(int x, int y)>;

  Mouse();
  ~Mouse();
  Mouse(const Mouse&) = delete;
  Mouse& operator=(const Mouse&) = delete;

  /// Handles the mouse input of one frame, read from ImGui. `simulation` is nullptr while a recording is
  /// shown. Throws Error when a requested action is impossible.
  void update(render::Camera& camera, Simulation* simulation, const ViewArea& area, const Pick& pick);
  /// Releases grab and drag, for instance when the scene or its world was replaced.
  void release();

  bool grabbing() const { return grab_ != nullptr; }
  Vec3f grabbed_point() const;  ///< current position of the grabbed point [m]
  Vec3f drag_target() const;    ///< position to which the mouse pulls it [m]

 private:
  enum class Drag { none, grab, orbit, pan };

  void press(const render::Camera& camera, Simulation* simulation, const ViewArea& area, const Pick& pick);
  void drag(render::Camera& camera, const ViewArea& area);

  Drag drag_ = Drag::none;
  std::unique_ptr<Grab> grab_;
  std::optional<host::DragPlane> plane_;
};

}  // namespace souple::viewer
