#include "app/view/window.h"

#include "app/view/keys.h"
#include "app/view/ui.h"
#include "render/context.h"
#include "souple/error.h"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <string>
#include <thread>
#include <utility>
#include <vector>

// GLFW's own OpenGL header would conflict with epoxy's.
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <epoxy/gl.h>
#include <imgui.h>

namespace souple::viewer {

namespace {

constexpr const char* render_instead =
    "; `souple render` makes pictures and films without a screen, and `ssh -X` shows windows on another "
    "machine";

/// GLFW's last error message.
std::string glfw_message() {
  const char* text = nullptr;
  glfwGetError(&text);
  return text != nullptr ? text : "no reason was given";
}

/// Initializes GLFW for its lifetime.
class Glfw {
 public:
  Glfw() {
    if (glfwInit() != GLFW_TRUE) throw Error("no window can be opened: " + glfw_message() + render_instead);
  }
  ~Glfw() { glfwTerminate(); }
  Glfw(const Glfw&) = delete;
  Glfw& operator=(const Glfw&) = delete;
};

/// The part of the main screen that panels of the desktop leave, in screen units before scaling.
WindowArea screen_area() {
  GLFWmonitor* monitor = glfwGetPrimaryMonitor();
  if (monitor == nullptr) return {};
  int x = 0, y = 0;
  WindowArea area;
  glfwGetMonitorWorkarea(monitor, &x, &y, &area.width, &area.height);
  float scale_x = 1, scale_y = 1;  // GLFW_SCALE_TO_MONITOR multiplies the size that is asked for
  glfwGetMonitorContentScale(monitor, &scale_x, &scale_y);
  if (scale_x > 1) area.width = static_cast<int>(static_cast<float>(area.width) / scale_x);
  if (scale_y > 1) area.height = static_cast<int>(static_cast<float>(area.height) / scale_y);
  return area;
}

/// Target of a window's callbacks.
struct Inbox {
  std::vector<std::filesystem::path> dropped;
};

class Window {
 public:
  Window(int width, int height, bool debug) {
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
    glfwWindowHint(GLFW_OPENGL_DEBUG_CONTEXT, debug ? GLFW_TRUE : GLFW_FALSE);
    glfwWindowHint(GLFW_SCALE_TO_MONITOR, GLFW_TRUE);
    window_ = glfwCreateWindow(width, height, "Souple", nullptr, nullptr);
    if (window_ == nullptr) {
      throw Error("no window with OpenGL 3.3 can be opened: " + glfw_message() +
                  "; expected a graphics driver, such as the package libgl1-mesa-dri" + render_instead);
    }
    glfwMakeContextCurrent(window_);
    glfwSwapInterval(1);
    glfwSetWindowUserPointer(window_, &inbox_);
    glfwSetDropCallback(window_, [](GLFWwindow* window, int count, const char** paths) {
      auto& inbox = *static_cast<Inbox*>(glfwGetWindowUserPointer(window));
      for (int i = 0; i < count; ++i) inbox.dropped.emplace_back(paths[i]);
    });
    // Passed as a character, so that a press shorter than a frame is not lost. ImGui's own callback calls
    // this one.
    glfwSetKeyCallback(window_, [](GLFWwindow*, int key, int, int action, int) {
      if (key == GLFW_KEY_ESCAPE && action == GLFW_PRESS) ImGui::GetIO().AddInputCharacter(escape);
    });
  }
  ~Window() { glfwDestroyWindow(window_); }
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  GLFWwindow* get() { return window_; }
  std::vector<std::filesystem::path> dropped() { return std::exchange(inbox_.dropped, {}); }

  void set_title(const std::string& title) {
    if (title != title_) glfwSetWindowTitle(window_, title.c_str());
    title_ = title;
  }
  bool iconified() const { return glfwGetWindowAttrib(window_, GLFW_ICONIFIED) == GLFW_TRUE; }

  /// Scale of text relative to an ordinary screen, in units of the mouse.
  float scale() const {
    float x = 1, y = 1;
    glfwGetWindowContentScale(window_, &x, &y);
    int width = 0, pixels = 0, height = 0;
    glfwGetWindowSize(window_, &width, &height);
    glfwGetFramebufferSize(window_, &pixels, &height);
    const float per_unit =
        width > 0 && pixels > 0 ? static_cast<float>(pixels) / static_cast<float>(width) : 1;
    return x / per_unit;
  }

 private:
  GLFWwindow* window_ = nullptr;
  Inbox inbox_;
  std::string title_;
};

/// ImGui's backend that reads the window's input.
class WindowInput {
 public:
  explicit WindowInput(GLFWwindow* window) { ImGui_ImplGlfw_InitForOpenGL(window, true); }
  ~WindowInput() { ImGui_ImplGlfw_Shutdown(); }
  WindowInput(const WindowInput&) = delete;
  WindowInput& operator=(const WindowInput&) = delete;
};

/// Returns the seconds since its last call.
class FrameTimer {
 public:
  double lap() {
    const Clock::time_point now = Clock::now();
    return std::chrono::duration<double>(now - std::exchange(last_, now)).count();
  }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point last_ = Clock::now();
};

void loop(Window& window, Viewer& viewer, const WindowOptions& options) {
  FrameTimer timer;
  for (std::uint64_t picture = 0; !options.frames || picture < *options.frames; ++picture) {
    glfwPollEvents();
    for (const std::filesystem::path& path : window.dropped()) viewer.open(path);
    ImGui_ImplGlfw_NewFrame();
    viewer.frame(timer.lap());
    if (options.debug) render::throw_gl_errors();
    window.set_title("Souple: " + viewer.session().name());
    if (options.interrupted && options.interrupted()) return;
    if (viewer.done() || glfwWindowShouldClose(window.get()) != 0) return;
    glfwSwapBuffers(window.get());
    // An iconified window needs no frames.
    if (window.iconified()) std::this_thread::sleep_for(std::chrono::milliseconds(15));
  }
}

}  // namespace

WindowArea fitted(WindowArea wanted, WindowArea screen) {
  constexpr int title = 40;  // and a border
  if (screen.width <= 0 || screen.height <= 0) return wanted;
  return {std::min(wanted.width, screen.width),
          std::min(wanted.height, std::max(screen.height - title, screen.height / 2))};
}

void run_window(SceneList scenes, std::unique_ptr<Session> session, const WindowOptions& options) {
  const Glfw glfw;
  const WindowArea size = fitted({options.width, options.height}, screen_area());
  Window window(size.width, size.height, options.debug);
  if (options.debug) render::watch_gl_errors();
  const Ui ui(window.scale());
  const WindowInput input(window.get());
  ViewerOptions viewer_options = options.viewer;
  viewer_options.half_resolution = viewer_options.half_resolution || render::draws_in_software();
  Viewer viewer(std::move(scenes), std::move(session), std::move(viewer_options));
  loop(window, viewer, options);
}

}  // namespace souple::viewer
