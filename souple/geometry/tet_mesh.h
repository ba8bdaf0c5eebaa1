#pragma once

#include "souple/math/vec3.h"

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace souple {

/// Vertices (a, b, c, d) with (b - a) x (c - a) . (d - a) > 0.
using Tet = std::array<std::uint32_t, 4>;

/// A volume split into tetrahedra.
struct TetMesh {
  std::vector<Vec3d> positions;  ///< meters, in user order
  std::vector<Tet> tets;         ///< positively oriented
  /// Vertex indices of each named group, ascending.
  std::map<std::string, std::vector<std::uint32_t>> groups;
};

}  // namespace souple
