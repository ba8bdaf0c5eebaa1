#include <Core/Utils/Log.hpp>
#include <Engine/Data/BlinnPhongMaterial.hpp>
#include <Engine/Data/MaterialConverters.hpp>
#include <Engine/FrameInfo.hpp>
#include <Engine/RadiumEngine.hpp>
#include <Engine/Rendering/RenderObject.hpp>
#include <Engine/Rendering/RenderObjectManager.hpp>
#include <Engine/Scene/EntityManager.hpp>
#include <Engine/Scene/SignalManager.hpp>
#include <Engine/Scene/System.hpp>
#include <Engine/Scene/SystemDisplay.hpp>
#include <algorithm>
#include <cmath>
#include <limits>

namespace Ra {
namespace Engine {

namespace {

// Stands where Radium keeps its cameras, so that the name is taken.
class NoCameras : public Scene::System {
 public:
  void generateTasks(Core::TaskQueue* /*taskQueue*/, const FrameInfo& /*frameInfo*/) override {}
};

}  // namespace

RA_SINGLETON_IMPLEMENTATION(RadiumEngine);

RadiumEngine::RadiumEngine() = default;
RadiumEngine::~RadiumEngine() = default;

void RadiumEngine::initialize() {
  m_signalManager = std::make_unique<Scene::SignalManager>();
  m_entityManager = std::make_unique<Scene::EntityManager>();
  m_renderObjectManager = std::make_unique<Rendering::RenderObjectManager>();
  registerSystem("DefaultCameraManager", new NoCameras, std::numeric_limits<int>::min());
}

void RadiumEngine::initializeGL() {
  Data::EngineMaterialConverters::registerMaterialConverter("BlinnPhong",
                                                            Data::BlinnPhongMaterialConverter());
}

// The names of the systems stay taken, as in Radium: only a new instance has them free.
void RadiumEngine::cleanup() {
  Data::EngineMaterialConverters::removeMaterialConverter("BlinnPhong");
  m_signalManager->setOn(false);
  m_entityManager.reset();
  m_renderObjectManager.reset();
  for (auto& system : m_systems) system.second.reset();
}

void RadiumEngine::getTasks(Core::TaskQueue* taskQueue, Scalar dt) {
  static uint frame = 0;
  if (m_time.playing || m_time.single_step) m_time.advance(dt);
  m_time.single_step = false;
  const FrameInfo info{m_time.now, m_time.real ? dt : m_time.step, frame++};
  for (const auto& system : m_systems) system.second->generateTasks(taskQueue, info);
}

void RadiumEngine::endFrameSync() {
  m_entityManager->swapBuffers();
  m_signalManager->fireFrameEnded();
}

bool RadiumEngine::registerSystem(const std::string& name, Scene::System* system, int priority) {
  if (find_system(name) != m_systems.end()) {
    LOG(Core::Utils::logWARNING) << "a system " << name << " is there already, and stays";
    return false;
  }
  m_systems[{priority, name}] = std::shared_ptr<Scene::System>(system);
  return true;
}

Scene::System* RadiumEngine::getSystem(const std::string& system) const {
  const auto found = find_system(system);
  return found == m_systems.end() ? nullptr : found->second.get();
}

RadiumEngine::Systems::const_iterator RadiumEngine::find_system(const std::string& name) const {
  return std::find_if(m_systems.begin(), m_systems.end(),
                      [&name](const auto& entry) { return entry.first.second == name; });
}

Core::Aabb RadiumEngine::computeSceneAabb() const {
  Core::Aabb box;
  for (Scene::Entity* entity : m_entityManager->getEntities()) {
    if (entity != Scene::SystemEntity::getInstance()) box.extend(entity->computeAabb());
  }
  return box;
}

bool RadiumEngine::setConstantTimeStep(Scalar dt, bool forceConstantTime) {
  m_time.step = dt;
  if (forceConstantTime) m_time.real = false;
  return !m_time.real;
}

void RadiumEngine::setForwardBackward(bool mode) {
  m_time.forward_backward = mode;
  if (!mode) m_time.backward = false;
}

void RadiumEngine::resetTime() {
  m_time.playing = false;
  m_time.single_step = false;
  m_time.now = m_time.start;
}

uint RadiumEngine::getFrame() const {
  return static_cast<uint>(std::ceil(m_time.now / m_time.step));
}

Core::TaskQueue::TaskId RadiumEngine::addGpuTask(std::unique_ptr<Core::Task> task) {
  return m_gpuTasks.registerTask(std::move(task));
}

// What is given is added to the step of the mode, so that a frame takes about two: as Radium's clock does.
void RadiumEngine::Clock::advance(Scalar given) {
  const Scalar change = given + (real ? given : step);
  now += forward_backward && backward ? -change : change;
  if (end < 0 || start >= end) {
    backward = false;
  } else if (now < start) {
    now = start;
    backward = false;
  } else if (now > end) {
    turn_back();
  }
}

void RadiumEngine::Clock::turn_back() {
  if (!forward_backward) {
    now = start +
          static_cast<Scalar>(std::fmod(static_cast<double>(now - start), static_cast<double>(end - start)));
    return;
  }
  now = backward ? end : 2 * end - now;
  backward = true;
}

}  // namespace Engine
}  // namespace Ra
