#pragma once

#include <cstddef>
#include <cstdint>

// Boxes against boxes, a register at a time: compiled once for each instruction set.

namespace souple::kernels {

/// Boxes of vertices, edges or triangles, and their particles, as columns. Box i extends from lo[0][i] to
/// hi[0][i] along x, and so on. max_items values after the last one are readable. An empty box, which
/// overlaps no other box, has lo above hi.
struct BoxColumns {
  const float* lo[3];
  const float* hi[3];
  const std::uint32_t* particle[3];  ///< one column per corner
};

/// Items [begin, begin + count), at most max_items, and a box around them: lo, hi.
struct BoxGroup {
  static constexpr std::uint32_t max_items = 32;
  std::uint32_t begin, count;
  float box[6];
  std::uint32_t marked = ~0u;  ///< bit k: item k. Pairs of two unmarked items are skipped.
};

/// Four particles: a vertex and a triangle, or two edges. A vertex is stored as an edge from it to itself.
using Quad = std::uint32_t[4];

struct PatchKernels {
  /// Writes the pairs of a vertex and a triangle whose boxes overlap and that share no particle, by vertex,
  /// then triangle. Returns their number. `pairs`, here and below, needs capacity for all possible pairs.
  std::size_t (*vertices_triangles)(const BoxColumns& vertices, const BoxGroup& v,
                                    const BoxColumns& triangles, const BoxGroup& t, Quad* pairs);
  /// Likewise for vertices and edges.
  std::size_t (*vertices_edges)(const BoxColumns& vertices, const BoxGroup& v, const BoxColumns& edges,
                                const BoxGroup& e, Quad* pairs);
  /// Likewise for edges of two groups. If a and b begin at one index, lists each pair of the group once.
  std::size_t (*edges_edges)(const BoxColumns& edges, const BoxGroup& a, const BoxGroup& b, Quad* pairs);
  /// Finds the items of [begin, begin + count) that overlap the box and whose keys[i] & mask is 0. Writes their keys[i]
  /// to `found`, which needs capacity for all. Returns their number.
  std::size_t (*overlapping)(const BoxColumns& boxes, std::size_t begin, std::size_t count,
                             const float (&box)[6], const std::uint32_t* keys, std::uint32_t mask,
                             std::uint32_t* found);
};

template <class Isa>
const PatchKernels& patch_kernels();

}  // namespace souple::kernels
