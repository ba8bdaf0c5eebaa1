#pragma once

#include <Core/Types.hpp>
#include <Core/Utils/IndexedObject.hpp>
#include <Core/Utils/Observable.hpp>
#include <Engine/RaEngine.hpp>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

namespace Ra {
namespace Engine {
namespace Scene {

class Component;

/// Components under one transform. A transform that is set is seen after the buffers are swapped.
class Entity : public Core::Utils::IndexedObject {
 public:
  explicit Entity(const std::string& name = "");
  Entity(const Entity&) = delete;
  Entity& operator=(const Entity&) = delete;
  ~Entity() override;

  const std::string& getName() const { return m_name; }
  void rename(const std::string& name) { m_name = name; }

  void setTransform(const Core::Transform& transform);
  void setTransform(const Core::Matrix4& transform) { setTransform(Core::Transform(transform)); }
  const Core::Transform& getTransform() const;
  const Core::Matrix4& getTransformAsMatrix() const { return getTransform().matrix(); }
  void swapTransformBuffers();
  Core::Utils::Observable<const Entity*>& transformationObservers() const {
    return m_transformationObservers;
  }

  void addComponent(Component* component);
  /// Throws std::out_of_range if there is none of that name; Radium's behavior is undefined.
  void removeComponent(const std::string& name);
  Component* getComponent(const std::string& name);
  const Component* getComponent(const std::string& name) const;
  const std::vector<std::unique_ptr<Component>>& getComponents() const { return m_components; }
  uint getNumComponents() const { return static_cast<uint>(m_components.size()); }

  virtual Core::Aabb computeAabb();
  void invalidateAabb() { m_isAabbValid = false; }

 private:
  Core::Transform m_transform;
  Core::Transform m_doubleBufferedTransform;
  mutable std::mutex m_transformMutex;
  std::vector<std::unique_ptr<Component>> m_components;
  std::string m_name;
  bool m_transformChanged = false;
  bool m_isAabbValid = false;
  Core::Aabb m_aabb;
  mutable Core::Utils::Observable<const Entity*> m_transformationObservers;
};

}  // namespace Scene
}  // namespace Engine
}  // namespace Ra
