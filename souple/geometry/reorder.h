#pragma once

#include "souple/math/vec3.h"

#include <cstdint>
#include <span>
#include <vector>

namespace souple {

// Renumbering for locality: particles that meet in constraints should meet in the cache. An order says which
// vertex comes k-th: order[k].

/// Along the Morton (Z-order) curve through the bounding box, 2^21 steps a side; ties keep their order, and
/// vertices that are not finite come last.
std::vector<std::uint32_t> morton_order(std::span<const Vec3d> positions);

/// inverse[order[k]] = k: the new number of each vertex.
std::vector<std::uint32_t> inverse_order(std::span<const std::uint32_t> order);

}  // namespace souple
