#pragma once

#include <cstdint>
#include <limits>

// Values that stand for "not one". For sources only: the names are short.

namespace souple {

inline constexpr float infinity = std::numeric_limits<float>::infinity();
/// No index of a vertex, an edge, a triangle, a particle.
inline constexpr std::uint32_t no_index = std::numeric_limits<std::uint32_t>::max();

}  // namespace souple
