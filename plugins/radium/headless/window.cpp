#include "plugins/radium/headless/window.h"

#include <Core/Asset/Camera.hpp>
#include <Core/Tasks/TaskQueue.hpp>
#include <Engine/Data/ViewingParameters.hpp>
#include <Engine/RadiumEngine.hpp>
#include <Engine/Rendering/ForwardRenderer.hpp>
#include <Engine/Scene/CameraComponent.hpp>
#include <Engine/Scene/CameraManager.hpp>
#include <Engine/Scene/DirLight.hpp>
#include <Engine/Scene/EntityManager.hpp>
#include <Engine/Scene/SystemDisplay.hpp>
#include <Headless/CLIViewer.hpp>
#include <Headless/OpenGLContext/EglOpenGLContext.hpp>
#include <Headless/OpenGLContext/GlfwOpenGLContext.hpp>
#include <cmath>
#include <souple/error.h>
#include <sys/wait.h>
#include <unistd.h>

namespace souple::radium {

namespace {

using Ra::Core::Vector2;
using Ra::Core::Vector3;
using Ra::Engine::Rendering::Renderer;

const glbinding::Version opengl{4, 1};

/// Radium ends the program if it gets no context: a child process tries it first.
template <class Context>
bool is_there() {
  const pid_t child = fork();
  if (child == 0) {
    const Context context(opengl);
    _exit(context.isValid() ? 0 : 1);
  }
  int status = 1;
  return child > 0 && waitpid(child, &status, 0) == child && WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

Vector3 vector(const std::array<float, 3>& values) {
  return {values[0], values[1], values[2]};
}

/// Transform of a camera that looks along -Z, with Y up.
Ra::Core::Transform frame_of(const Vector3& from, const Vector3& way) {
  const Vector3 back = -way.normalized(), right = Vector3::UnitY().cross(back).normalized();
  Ra::Core::Transform frame = Ra::Core::Transform::Identity();
  frame.linear() << right, back.cross(right), back;
  frame.translation() = from;
  return frame;
}

void add_light(Renderer& renderer, const char* name, const Vector3& direction, float strength) {
  auto* light = new Ra::Engine::Scene::DirectionalLight(Ra::Engine::Scene::SystemEntity::getInstance(),
                                                        name);  // the entity's
  light->setColor(Ra::Core::Utils::Color::Gray(strength));
  light->setDirection(direction.normalized());
  renderer.addLight(light);
}

}  // namespace

std::unique_ptr<Ra::Headless::OpenGLContext> make_context() {
#ifdef HEADLESS_HAS_EGL
  using Ra::Headless::EglOpenGLContext;
  if (is_there<EglOpenGLContext>()) return std::make_unique<EglOpenGLContext>(opengl);
#endif
#ifdef HEADLESS_HAS_GLFW
  using Ra::Headless::GlfwOpenGLContext;
  if (is_there<GlfwOpenGLContext>()) return std::make_unique<GlfwOpenGLContext>(opengl);
#endif
  return nullptr;
}

Window::Window(std::unique_ptr<Ra::Headless::OpenGLContext> context, int width, int height)
    : viewer_(std::make_unique<Ra::Headless::CLIViewer>(std::move(context))), width_(width), height_(height) {
  const std::string size = std::to_string(width) + "x" + std::to_string(height);
  const char* arguments[] = {"souple_radium_headless", "-s", size.c_str()};
  if (viewer_->init(3, arguments) != 0) throw Error("Radium does not start");
  renderer_ = new Ra::Engine::Rendering::ForwardRenderer;  // the viewer deletes it
  viewer_->setRenderer(renderer_);
  engine().setConstantTimeStep(frame_time, true);
  viewer_->bindOpenGLContext();
}

Window::~Window() = default;

Ra::Engine::RadiumEngine& Window::engine() {
  return *viewer_->m_engine;
}

void Window::look(const View& view) {
  auto* entity = engine().getEntityManager()->createEntity("camera");
  auto* component = new Ra::Engine::Scene::CameraComponent(entity, "camera", static_cast<float>(height_),
                                                           static_cast<float>(width_));  // the entity's
  component->initialize();
  camera_ = component->getCamera();
  const Vector3 from = vector(view.from), way = vector(view.to) - from;
  const float aspect = static_cast<float>(width_) / static_cast<float>(height_);
  const float half = std::tan(view.angle / 360 * 3.14159265f);
  camera_->setFOV(2 * std::atan(aspect * half));  // Radium's field of view is horizontal
  camera_->setZNear(0.01f * way.norm());
  camera_->setZFar(100 * way.norm());
  camera_->setFrame(frame_of(from, way));

  auto* cameras = dynamic_cast<Ra::Engine::Scene::CameraManager*>(engine().getSystem("DefaultCameraManager"));
  cameras->addCamera(component);
  cameras->getActiveCamera()->setViewport(static_cast<float>(width_), static_cast<float>(height_));
  viewer_->setCamera(cameras->getCameraIndex(component));
  camera_ = cameras->getActiveCamera();
}

void Window::prepare() {
  // The viewer's own light shines only from the eye: a floor seen edge-on would be black.
  if (!renderer_->hasLight()) {
    add_light(*renderer_, "light from above", facing() - Vector3(0.6f, 1.2f, 0), 1.6f);
    add_light(*renderer_, "light from the eye", facing(), 0.8f);
  }
  viewer_->compileScene();
}

void Window::run_frame() {
  Ra::Core::TaskQueue tasks(1);
  engine().getTasks(&tasks, frame_time);
  tasks.runTasksInThisThread();
  engine().endFrameSync();
}

Picture Window::draw() {
  renderer_->render({camera_->getViewMatrix(), camera_->getProjMatrix(), frame_time});
  Picture picture;
  const auto pixels = renderer_->grabFrame(picture.width, picture.height);
  picture.pixels.assign(pixels.get(), pixels.get() + 4 * picture.width * picture.height);
  return picture;
}

Vector2 Window::pixel_of(const Vector3& point) const {
  return camera_->projectToScreen(point).head<2>();
}

bool Window::shows(const Vector2& pixel) const {
  return pixel.x() >= 0 && pixel.y() >= 0 && pixel.x() < static_cast<float>(width_) &&
         pixel.y() < static_cast<float>(height_);
}

Ra::Core::Ray Window::ray_through(const Vector2& pixel) const {
  return camera_->getRayFromScreen(pixel);
}

Vector3 Window::facing() const {
  return camera_->getDirection();
}

PickedVertex Window::pick(const Vector2& pixel) {
  const Vector2 from_below(pixel.x(), static_cast<float>(height_) - pixel.y());
  const auto picked = renderer_->doPickingNow({from_below, Renderer::SELECTION, Renderer::RO},
                                              {camera_->getViewMatrix(), camera_->getProjMatrix(), 0});
  if (picked.getRoIdx().isInvalid() || picked.getIndices().empty()) return {};
  const auto& [triangle, corner, edge] = picked.getIndices().front();
  return {picked.getRoIdx(), triangle, corner};
}

}  // namespace souple::radium
