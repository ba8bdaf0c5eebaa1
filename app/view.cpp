#include "app/commands.h"
#include "app/exit_codes.h"
#include "app/find_scene.h"
#include "app/interrupt.h"
#include "app/picture_arguments.h"
#include "app/view/scene_list.h"
#include "app/view/window.h"
#include "souple/error.h"

#include <filesystem>
#include <memory>
#include <utility>

namespace souple::app {

namespace {

/// An existing folder or file as it is; otherwise the shipped scene of that name.
std::filesystem::path what_to_view(const std::string& what) {
  std::error_code error;
  if (!what.empty())
    return std::filesystem::is_directory(what, error) ? std::filesystem::path(what) : find_scene(what);
  const std::vector<ShippedScene> shipped = shipped_scenes();
  if (shipped.empty()) throw Error("no scenes found; name a scene file, or see `souple info`");
  for (const ShippedScene& scene : shipped) {
    if (scene.name == "curtain") return scene.file;
  }
  return shipped.front().file;
}

}  // namespace

bool has_viewer() {
  return true;
}

int view(const ViewRequest& request) {
  viewer::WindowOptions window;
  if (!request.size.empty()) {
    const PictureSize size = parse_size(request.size);
    window.width = size.width, window.height = size.height;
  }
  window.frames = request.frames;
  window.debug = request.debug;
  window.viewer.paused = request.paused;
  viewer::SceneList scenes(shipped_scenes());
  // Opened before the window: errors in a scene are printed in the terminal.
  std::unique_ptr<viewer::Session> session = scenes.open(what_to_view(request.source));
  // Ctrl-C in the terminal finishes a film that is being recorded.
  watch_interrupts();
  window.interrupted = interrupt_requested;
  viewer::run_window(std::move(scenes), std::move(session), window);
  return interrupt_requested() ? interrupted : success;
}

}  // namespace souple::app
