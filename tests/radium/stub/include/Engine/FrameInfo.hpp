#pragma once

#include <Engine/RaEngine.hpp>

namespace Ra {
namespace Engine {

struct FrameInfo {
  Scalar m_animationTime = 0;
  Scalar m_dt = 0;
  uint m_numFrame = 0;
};

}  // namespace Engine
}  // namespace Ra
