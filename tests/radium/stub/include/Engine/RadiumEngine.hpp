#pragma once

#include <Core/Tasks/TaskQueue.hpp>
#include <Core/Types.hpp>
#include <Core/Utils/Singleton.hpp>
#include <Engine/RaEngine.hpp>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>

namespace Ra {
namespace Engine {
namespace Scene {
class EntityManager;
class SignalManager;
class System;
}  // namespace Scene
namespace Rendering {
class RenderObjectManager;
}

class RadiumEngine {
  RA_SINGLETON_INTERFACE(RadiumEngine);

 public:
  void initialize();
  /// Needs no GL here; what it does is to register the converter of Blinn-Phong materials.
  void initializeGL();
  /// To be called before the instance goes: its parts still ask for it.
  void cleanup();

  /// One frame: the time goes on, then every system is asked, greatest priority first.
  void getTasks(Core::TaskQueue* taskQueue, Scalar dt);
  void endFrameSync();

  /// Takes the system. False if the name is there: the new one is then nobody's.
  bool registerSystem(const std::string& name, Scene::System* system, int priority = 1);
  /// nullptr if there is none.
  Scene::System* getSystem(const std::string& system) const;

  Rendering::RenderObjectManager* getRenderObjectManager() const { return m_renderObjectManager.get(); }
  Scene::EntityManager* getEntityManager() const { return m_entityManager.get(); }
  Scene::SignalManager* getSignalManager() const { return m_signalManager.get(); }

  /// Of all entities but the system's own.
  Core::Aabb computeSceneAabb() const;

  void setRealTime(bool realTime) { m_time.real = realTime; }
  bool isRealTime() const { return m_time.real; }
  bool isConstantTime() const { return !m_time.real; }
  bool setConstantTimeStep(Scalar dt, bool forceConstantTime = false);
  void setForwardBackward(bool mode);
  void play(bool isPlaying) { m_time.playing = isPlaying; }
  void step() { m_time.single_step = true; }
  void resetTime();
  void setTime(Scalar t) { m_time.now = t; }
  Scalar getTime() const { return m_time.now; }
  void setStartTime(Scalar t) { m_time.start = t > 0 ? t : 0; }
  Scalar getStartTime() const { return m_time.start; }
  void setEndTime(Scalar t) { m_time.end = t; }
  Scalar getEndTime() const { return m_time.end; }
  uint getFrame() const;

  void runGpuTasks() { m_gpuTasks.runTasksInThisThread(); }
  Core::TaskQueue::TaskId addGpuTask(std::unique_ptr<Core::Task> task);
  void removeGpuTask(Core::TaskQueue::TaskId taskId) { m_gpuTasks.removeTask(taskId); }

 private:
  /// Times in seconds. A window that is empty, or ends before 0, has no end.
  struct Clock {
    void advance(Scalar given);
    void turn_back();

    Scalar step = 1.0F / 60.0F;
    Scalar start = 0;
    Scalar end = 1;
    Scalar now = 0;
    bool playing = false;
    bool single_step = true;
    bool real = false;
    bool forward_backward = false;
    bool backward = false;
  };

  using Systems = std::map<std::pair<int, std::string>, std::shared_ptr<Scene::System>, std::greater<>>;

  RadiumEngine();
  ~RadiumEngine();

  Systems::const_iterator find_system(const std::string& name) const;

  Systems m_systems;
  std::unique_ptr<Rendering::RenderObjectManager> m_renderObjectManager;
  std::unique_ptr<Scene::EntityManager> m_entityManager;
  std::unique_ptr<Scene::SignalManager> m_signalManager;
  Clock m_time;
  Core::TaskQueue m_gpuTasks{0};
};

}  // namespace Engine
}  // namespace Ra
