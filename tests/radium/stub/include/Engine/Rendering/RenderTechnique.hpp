#pragma once

#include <Engine/RaEngine.hpp>

namespace Ra {
namespace Engine {
namespace Rendering {

/// How an object is drawn; here it is not.
class RenderTechnique {
 public:
  static RenderTechnique createDefaultRenderTechnique() { return {}; }
};

}  // namespace Rendering
}  // namespace Engine
}  // namespace Ra
