#pragma once

#include "plugins/radium/headless/pure_run.h"
#include "plugins/radium/physics_system.h"

#include <Core/Types.hpp>
#include <memory>
#include <string>
#include <vector>

namespace Ra {
namespace Core::Asset {
class Camera;
}
namespace Engine::Rendering {
class Renderer;
}
namespace Headless {
class CLIViewer;
class OpenGLContext;
}  // namespace Headless
}  // namespace Ra

namespace souple::radium {

struct Picture {
  std::size_t width = 0, height = 0;
  std::vector<unsigned char> pixels;  ///< red, green, blue, alpha; rows from the top
};

/// An OpenGL context without a window: from EGL if there is a device, else from GLFW, which needs a
/// display. nullptr if there is neither.
std::unique_ptr<Ra::Headless::OpenGLContext> make_context();

/// Radium Engine drawing into memory.
class Window {
 public:
  static constexpr float frame_time = 1.0f / 60;  ///< s

  Window(std::unique_ptr<Ra::Headless::OpenGLContext> context, int width, int height);
  ~Window();
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  Ra::Engine::RadiumEngine& engine();
  void look(const View& view);
  /// Call after changes of the scene: Radium does not draw new objects otherwise.
  void prepare();
  /// Runs the engine's tasks like every host of Radium, without drawing.
  void run_frame();
  Picture draw();

  // --- a pixel is counted from the top left
  Ra::Core::Vector2 pixel_of(const Ra::Core::Vector3& point) const;
  bool shows(const Ra::Core::Vector2& pixel) const;
  Ra::Core::Ray ray_through(const Ra::Core::Vector2& pixel) const;
  Ra::Core::Vector3 facing() const;
  /// The object drawn there; its render object is invalid if there is none.
  PickedVertex pick(const Ra::Core::Vector2& pixel);

 private:
  std::unique_ptr<Ra::Headless::CLIViewer> viewer_;
  Ra::Engine::Rendering::Renderer* renderer_ = nullptr;  // the viewer's
  Ra::Core::Asset::Camera* camera_ = nullptr;            // the engine's
  int width_, height_;
};

}  // namespace souple::radium
