#pragma once

#include <Core/Utils/Color.hpp>
#include <Core/Utils/Singleton.hpp>
#include <Engine/RaEngine.hpp>
#include <Engine/Scene/Component.hpp>
#include <Engine/Scene/Entity.hpp>

namespace Ra {
namespace Engine {
namespace Scene {

class DebugComponent : public Component {
 public:
  explicit DebugComponent(Entity* entity) : Component("Debug", entity) {}
  void initialize() override {}
  Rendering::RenderObject* getRenderObject(Core::Utils::Index idx);
};

class UiComponent : public Component {
 public:
  explicit UiComponent(Entity* entity) : Component("UI", entity) {}
  void initialize() override {}
};

/// The entity of what belongs to no scene: grid, gizmos, lines for debugging.
class SystemEntity : public Entity {
  RA_SINGLETON_INTERFACE(SystemEntity);

 public:
  SystemEntity();
  ~SystemEntity() override = default;

  static DebugComponent* dbgCmp();
  static UiComponent* uiCmp();
};

}  // namespace Scene
}  // namespace Engine
}  // namespace Ra
