#pragma once

#include <cstdint>

namespace souple {

/// A vertex near a triangle (particles v; a, b, c), or an edge near an edge (a, b; c, d). A grain near an
/// edge of a rope is stored as an edge from its particle to itself (v, v; a, b).
struct NearPair {
  std::uint32_t particle[4];
};

}  // namespace souple
