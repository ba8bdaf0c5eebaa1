// Shows a scene of Souple in Radium without a window and checks the adapter. It is also an
// example of the adapter without Qt.
#include "plugins/radium/headless/checks.h"
#include "plugins/radium/headless/picture.h"

#include <Engine/RadiumEngine.hpp>
#include <Headless/OpenGLContext/OpenGLContext.hpp>
#include <cstdlib>
#include <exception>
#include <iostream>
#include <set>
#include <souple/error.h>
#include <string>

namespace souple::radium {
namespace {

constexpr int success = 0, wrong = 1, bad_use = 2, skipped = 77;  // 77 means "skipped" for CTest

const char* const help = R"(souple_radium_headless --scene FILE [--frames N] [--picture FILE.png]

Opens a Souple scene in Radium, without a window, and checks: the buttons make exactly their
steps, pictures change while it plays, vertices are picked and grabbed, and after N frames
(100) all is, bit for bit, where a run without Radium is. The picture is of that moment.

Exit codes: 0 all is well, 1 something is not, 2 bad use, 77 no OpenGL.
)";

struct Options {
  std::string scene, picture;
  int frames = 100;
  bool help = false;
};

Options parse(int count, char** arguments) {
  Options options;
  for (int i = 1; i < count; ++i) {
    const std::string name = arguments[i];
    if (name == "--help" || name == "-h") {
      options.help = true;
      return options;
    }
    if (i + 1 == count) throw Error(name + ": unknown, or its value is missing; see --help");
    const std::string value = arguments[++i];
    if (name == "--scene")
      options.scene = value;
    else if (name == "--picture")
      options.picture = value;
    else if (name == "--frames")
      options.frames = std::atoi(value.c_str());
    else
      throw Error(name + ": unknown; see --help");
  }
  if (options.scene.empty()) throw Error("--scene is missing; see --help");
  if (options.frames < 1) throw Error("--frames: expected 1 or more");
  return options;
}

int run(const Options& options) {
  const View view = view_of_scene(options.scene);
  auto context = make_context();
  if (!context) {
    std::cout << "no OpenGL 4.1: there is neither an EGL device nor a display\n";
    return skipped;
  }
  Window window(std::move(context), 960, 640);
  PhysicsSystem* system = PhysicsSystem::add_to(window.engine());
  system->open_scene(options.scene);
  window.look(view);
  window.prepare();

  Checks checks;
  Show show{window, *system, options.scene, options.frames};
  check_buttons(show, checks);
  check_pictures(show, checks);
  check_against_pure_run(show, checks);
  check_picking(show, checks);
  const std::vector<std::string> messages = system->take_messages();
  for (const std::string& message : std::set<std::string>(messages.begin(), messages.end()))
    std::cout << "said: " << message << "\n";
  if (!options.picture.empty()) write_png(options.picture, window.draw());
  return checks.failed() == 0 ? success : wrong;
}

int run_program(int count, char** arguments) {
  try {
    const Options options = parse(count, arguments);
    if (!options.help) return run(options);
    std::cout << help;
    return success;
  } catch (const std::exception& error) {
    std::cerr << error.what() << "\n";
    return bad_use;
  }
}

}  // namespace
}  // namespace souple::radium

int main(int count, char** arguments) {
  return souple::radium::run_program(count, arguments);
}
