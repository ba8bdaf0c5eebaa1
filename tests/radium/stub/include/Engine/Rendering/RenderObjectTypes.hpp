#pragma once

namespace Ra {
namespace Engine {
namespace Rendering {

enum class RenderObjectType { UI = 0, Debug, Geometry, Count };

}  // namespace Rendering
}  // namespace Engine
}  // namespace Ra
