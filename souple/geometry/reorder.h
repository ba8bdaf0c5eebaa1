#pragma once

#include "souple/math/vec3.h"

#include <cstdint>
#include <span>
#include <vector>

namespace souple {

// Renumbering for cache locality: particles that share constraints should be close in memory. order[k] is the
// vertex at position k.

/// Order along the Morton (Z-order) curve through the bounding box, with 2^21 steps per side; ties keep their
/// order, and non-finite vertices come last.
std::vector<std::uint32_t> morton_order(std::span<const Vec3d> positions);

/// inverse[order[k]] = k: the new number of each vertex.
std::vector<std::uint32_t> inverse_order(std::span<const std::uint32_t> order);

}  // namespace souple
