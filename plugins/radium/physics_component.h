#pragma once

#include <Engine/Scene/Component.hpp>

namespace souple::radium {

/// Says in Radium's tree that something of this entity is an object of the world. Deleting it there ends
/// that.
class PhysicsComponent : public Ra::Engine::Scene::Component {
 public:
  using Component::Component;
  void initialize() override {}
};

}  // namespace souple::radium
