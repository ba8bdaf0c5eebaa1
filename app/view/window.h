#pragma once

#include "app/view/scene_list.h"
#include "app/view/session.h"
#include "app/view/viewer.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>

namespace souple::viewer {

struct WindowOptions {
  int width = 1440, height = 900;
  std::optional<std::uint64_t> frames;  ///< number of frames after which the window closes
  bool debug = false;                   ///< an OpenGL error ends the program with its message
  std::function<bool()> interrupted;    ///< called every frame; true closes the window. May be empty
  ViewerOptions viewer{};
};

/// Opens a window and shows the session until the user closes it. Throws Error if there is no screen, or no
/// screen with OpenGL 3.3; the message says which.
void run_window(SceneList scenes, std::unique_ptr<Session> session, const WindowOptions& options);

}  // namespace souple::viewer
