#pragma once

#include <Core/Types.hpp>
#include <Core/Utils/Index.hpp>
#include <Engine/RaEngine.hpp>
#include <string>
#include <vector>

namespace Ra {
namespace Engine {
namespace Rendering {
class RenderObject;
class RenderObjectManager;
}  // namespace Rendering
namespace Scene {

class Entity;
class System;

/// A part of an entity, which owns it from its construction on.
class Component {
 public:
  Component(const std::string& name, Entity* entity);
  Component(const Component&) = delete;
  Component& operator=(const Component&) = delete;
  virtual ~Component();

  virtual void initialize() = 0;

  virtual void setEntity(Entity* entity) { m_entity = entity; }
  virtual Entity* getEntity() const { return m_entity; }
  virtual const std::string& getName() const { return m_name; }
  virtual void setSystem(System* system) { m_system = system; }
  virtual System* getSystem() const { return m_system; }

  Core::Utils::Index addRenderObject(Rendering::RenderObject* renderObject);
  /// Ignored if the component has no such render object.
  void removeRenderObject(const Core::Utils::Index& roIdx);
  void notifyRenderObjectExpired(const Core::Utils::Index& idx);
  const std::vector<Core::Utils::Index>& getRenderObjects() { return m_renderObjects; }

  virtual bool canEdit(const Core::Utils::Index& /*roIdx*/) const { return false; }
  virtual Core::Transform getTransform(const Core::Utils::Index& /*roIdx*/) const {
    return Core::Transform::Identity();
  }
  virtual void setTransform(const Core::Utils::Index& /*roIdx*/, const Core::Transform& /*transform*/) {}

  /// Of the render objects that are visible.
  virtual Core::Aabb computeAabb();
  void invalidateAabb();

 protected:
  static Rendering::RenderObjectManager* getRoMgr();

 public:
  std::vector<Core::Utils::Index> m_renderObjects;

 protected:
  std::string m_name;
  Entity* m_entity = nullptr;
  System* m_system = nullptr;

 private:
  bool m_isAabbValid = false;
  Core::Aabb m_aabb;
};

}  // namespace Scene
}  // namespace Engine
}  // namespace Ra
