#pragma once

#include <Engine/Scene/Component.hpp>
#include <souple/host/session.h>
#include <string>

namespace souple::radium {

/// Says in Radium's tree that something of this entity is an object of the world. Deleting it there ends
/// that.
class PhysicsComponent : public Ra::Engine::Scene::Component {
 public:
  PhysicsComponent(const std::string& name, Ra::Engine::Scene::Entity* entity, host::Handle object)
      : Component(name, entity), object_(object) {}
  void initialize() override {}

  host::Handle object() const { return object_; }

 private:
  host::Handle object_;
};

}  // namespace souple::radium
