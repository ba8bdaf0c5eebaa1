#pragma once

#include "souple/geometry/adjacency.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace souple {

// Renumbering for locality: particles that meet in constraints should meet in the cache. Each function
// returns `order`: order[k] = which vertex comes k-th.

/// Along the Morton (Z-order) curve through the bounding box, 2^21 steps a side; ties keep their order, and
/// vertices that are not finite come last.
std::vector<std::uint32_t> morton_order(std::span<const Vec3d> positions);

/// Reverse Cuthill-McKee (Cuthill & McKee 1969, reversed by George 1971): breadth-first from a far end of
/// each piece, neighbours by degree, so that the ends of every edge get near numbers. Throws Error if an edge
/// names a vertex >= vertex_count.
std::vector<std::uint32_t> cuthill_mckee_order(std::span<const Edge> edges, std::size_t vertex_count);

/// inverse[order[k]] = k: the new number of each vertex.
std::vector<std::uint32_t> inverse_order(std::span<const std::uint32_t> order);

}  // namespace souple
