#pragma once

#include <Engine/Scene/Component.hpp>

namespace souple::radium {

/// Marks an entity in Radium's tree whose mesh is an object of the world. Deleting the mark removes the
/// object.
class PhysicsComponent : public Ra::Engine::Scene::Component {
 public:
  using Component::Component;
  void initialize() override {}
};

}  // namespace souple::radium
