#pragma once

#include <Core/RaCore.hpp>
#include <string>

namespace Ra {
namespace Core {
namespace Geometry {

enum MeshAttrib : uint {
  VERTEX_POSITION = 0,
  VERTEX_NORMAL,
  VERTEX_TANGENT,
  VERTEX_BITANGENT,
  VERTEX_TEXCOORD,
  VERTEX_COLOR,
  VERTEX_WEIGHTS,
  VERTEX_WEIGHT_IDX,
};

/// The name of the attribute, as the shaders know it.
const std::string& getAttribName(MeshAttrib index);

}  // namespace Geometry
}  // namespace Core
}  // namespace Ra
