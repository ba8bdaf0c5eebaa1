#pragma once

#include <Engine/RaEngine.hpp>
#include <utility>
#include <vector>

namespace Ra {
namespace Core {
class TaskQueue;
namespace Asset {
class FileData;
}
}  // namespace Core
namespace Engine {
struct FrameInfo;
namespace Scene {

class Component;
class Entity;

class System {
  friend class Component;

 public:
  System() = default;
  virtual ~System() = default;

  virtual void handleAssetLoading(Entity* /*entity*/, const Core::Asset::FileData* /*data*/) {}
  virtual void generateTasks(Core::TaskQueue* taskQueue, const Engine::FrameInfo& frameInfo) = 0;

  std::vector<Component*> getEntityComponents(const Entity* entity);
  void addComponent(Entity* entity, Component* component) { registerComponent(entity, component); }

 protected:
  virtual void registerComponent(const Entity* entity, Component* component);
  virtual void unregisterComponent(const Entity* entity, Component* component);
  virtual void unregisterAllComponents(const Entity* entity);

  std::vector<std::pair<const Entity*, Component*>> m_components;
};

}  // namespace Scene
}  // namespace Engine
}  // namespace Ra
