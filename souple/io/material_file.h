#pragma once

#include "souple/math/vec3.h"

#include <map>
#include <string>
#include <string_view>

namespace souple {

/// Properties that Souple reads from a material of an OBJ's .mtl file.
struct FileMaterial {
  Vec3f color{0.8f, 0.8f, 0.8f};  ///< Kd, in [0, 1]
  float opacity = 1;              ///< d, in [0, 1]
};

/// The materials of a .mtl by name. Lines that are not understood are left out.
std::map<std::string, FileMaterial> parse_materials(std::string_view text);

}  // namespace souple
