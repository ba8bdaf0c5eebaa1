#pragma once

#include "app/view/scene_list.h"
#include "app/view/session.h"
#include "app/view/viewer.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>

namespace souple::viewer {

/// The size of a window [screen units] that fits on a screen's work area: shrunk where it is larger, with room
/// for its title. A work area of 0 x 0 is unknown.
struct WindowArea {
  int width = 0, height = 0;
};
WindowArea fitted(WindowArea wanted, WindowArea screen);

struct WindowOptions {
  int width = 1440, height = 900;
  std::optional<std::uint64_t> frames;  ///< number of frames to draw before it closes; empty: no limit
  bool debug = false;                   ///< an OpenGL error ends the program with its message
  std::function<bool()> interrupted;    ///< called once per frame; true closes the window. May be empty
  ViewerOptions viewer{};
};

/// Opens a window and shows the session until the user closes it. Throws Error when there is no screen, or
/// none with OpenGL 3.3, and names the cause.
void run_window(SceneList scenes, std::unique_ptr<Session> session, const WindowOptions& options);

}  // namespace souple::viewer
