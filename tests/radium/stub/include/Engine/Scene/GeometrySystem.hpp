#pragma once

#include <Engine/Scene/System.hpp>

namespace Ra {
namespace Engine {
namespace Scene {

/// Owns the components with meshes; makes no tasks.
class GeometrySystem : public System {
 public:
  void generateTasks(Core::TaskQueue* /*taskQueue*/, const FrameInfo& /*frameInfo*/) override {}
};

}  // namespace Scene
}  // namespace Engine
}  // namespace Ra
